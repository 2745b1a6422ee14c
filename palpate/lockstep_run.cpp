#include "palpate/lockstep_run.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <optional>
#include <ostream>

#include "modules/bus/dds_bus.h"
#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/core/units.h"
#include "modules/recording/recorder_stage.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/periodic_loop.h"
#include "modules/runtime/realtime.h"
#include "modules/runtime/session.h"
#include "modules/runtime/snapshot.h"
#include "modules/runtime/wiring.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/processes.h"
#include "modules/scene/scene_reader.h"
#include "palpate/module_group.h"
#include "palpate/run_snapshot.h"
#include "palpate/scene_doubts.h"
#include "palpate/session/in_process.h"
#include "palpate/session_monitor.h"
#include "palpate/session_text.h"

namespace palpate::launcher {
namespace {

constexpr double kLongestWait = 0.01;  ///< before signals and processes are looked at again [s]
constexpr std::int64_t kProgressEveryNs = kNanosecondsPerSecond;
constexpr std::int64_t kGoodbyeNs = 10 * kNanosecondsPerSecond;

double duration_of(const RunOptions& options, const scene::Scene& scene) {
  const double duration = options.duration > 0 ? options.duration : scene.duration;
  if (duration > 0) return duration;
  throw InputError(scene.file.string() +
                   ": duration_s is 0; a run without a clock needs an end: give --duration");
}

/// Where a run begins.
runtime::Snapshot start_of(const RunOptions& options, const scene::Scene& scene) {
  if (options.from_snapshot.empty()) return {};
  runtime::Snapshot start = runtime::read_snapshot(options.from_snapshot, scene);
  for (const auto& [module, state] : start.modules) {
    if (runtime::module_named(module)) continue;
    throw InputError(
        fmt::format("{}: of a session whose probes {} guides: no process goes on there",
                    options.from_snapshot.string(), module));
  }
  return start;
}

/// A run begins before it ends, and a snapshot is taken on the way.
void check_times(const RunOptions& options, std::int64_t start_ns, double duration) {
  const double start = seconds_from_ns(start_ns);
  if (start >= duration) {
    throw InputError(
        fmt::format("{}: is of {:g} s, and the run ends at {:g} s: give a --duration beyond {:g}",
                    options.from_snapshot.string(), start, duration, start));
  }
  if (!options.snapshot_at) return;
  const bool later = ns_from_seconds(*options.snapshot_at) > start_ns;
  if (later && *options.snapshot_at <= duration) return;
  throw InputError(fmt::format("--snapshot-at {:.10g}: the run goes from {:.10g} to {:.10g} s",
                               *options.snapshot_at, start, duration));
}

/// "palpate:   3.20 of 20 s, 1.9 times real time"
class Progress {
 public:
  Progress(std::int64_t start_ns, double duration, std::ostream& out)
      : start_(seconds_from_ns(start_ns)), duration_(duration), out_(out) {}

  /// @param note  what is waited for; may be empty
  void tell(double simulated, const std::string& note) {
    const std::int64_t now_ns = runtime::monotonic_now_ns();
    if (now_ns - told_ns_ < kProgressEveryNs) return;
    told_ns_ = now_ns;
    const double wall = seconds_from_ns(now_ns - began_ns_);
    out_ << fmt::format("{:8.2f} of {:g} s, {:.2f} times real time{}{}", simulated, duration_,
                        (simulated - start_) / wall, note.empty() ? "" : ", ", note)
         << std::endl;
  }
  double wall_time() const { return seconds_from_ns(runtime::monotonic_now_ns() - began_ns_); }

 private:
  double start_, duration_;
  std::ostream& out_;
  std::int64_t began_ns_ = runtime::monotonic_now_ns();
  std::int64_t told_ns_ = began_ns_;
};

bus::BusOptions every_sample(bus::BusOptions options) {
  options.every_sample = true;
  return options;
}

/// Conducts the processes: grants simulated time, one piece ahead of the slowest.
class LockstepRun {
 public:
  LockstepRun(const RunOptions& options, std::ostream& out, std::ostream& log)
      : options_(options),
        out_(out),
        log_(log),
        scene_(scene::load_scene(options.scene)),
        digest_(scene::scene_digest(scene_)),
        duration_(duration_of(options, scene_)),
        start_ns_(start_of(options, scene_).time_ns),
        modules_(checked_commands(), log, Restarting::kNever, options.folder),
        names_(options.everywhere.empty() ? modules_.reporting_modules() : options.everywhere),
        bus_(every_sample(options.bus)),
        session_(bus_, digest_, runtime::Session::Kind::kLockstep),
        conductor_(bus_),
        scenes_(bus_.writer(bus::kScene)),
        monitor_(bus_, scene_) {}

  int perform() {
    SceneDescription description = runtime::scene_description(scene_);
    description.header.source_time_ns = runtime::CycleGrid::kSetUp;
    scenes_.write(description);
    remove_snapshot_parts(options_, names_);
    log_ << fmt::format("palpate: session {} of scene {}, in lockstep\n", options_.bus.session,
                        scene_.name);
    if (!wait_until_ready()) return end(false);
    monitor_.tally().start();
    if (options_.realtime) cores_.emplace().keep();
    Progress progress(start_ns_, duration_, out_);
    grant();
    while (next_cycle() && slowest_ns() < end_ns()) {
      grant();
      progress.tell(seconds_from_ns(slowest_ns()), waited_for());
    }
    const bool complete = slowest_ns() >= end_ns();
    return end(complete, progress.wall_time());
  }

 private:
  std::vector<ModuleCommand> checked_commands() const {
    check_times(options_, start_ns_, duration_);
    return module_commands(options_, program_folder(), scene::process_count(scene_));
  }
  std::int64_t end_ns() const { return ns_from_seconds(duration_); }

  /// False when a signal says stop, or a process has ended: without it nothing goes on.
  bool next_cycle() {
    monitor_.wait(kLongestWait);
    session_.poll();
    monitor_.poll();
    for (const auto& ended : modules_.poll()) {
      failures_[ended.module] = ended.how;
      if (ended.bad_input) exit_code_ = kExitBadInput;
      log_ << fmt::format("palpate: {} ended: {}; a lockstep session cannot go on without it\n",
                          ended.module, ended.how);
    }
    return !stop_.requested() && failures_.empty();
  }

  /// Over hosts as long as it takes: each is started by somebody.
  bool wait_until_ready() {
    const std::int64_t begin_ns = runtime::monotonic_now_ns();
    const std::int64_t deadline_ns = begin_ns + ns_from_seconds(options_.ready_deadline);
    std::int64_t line_ns = begin_ns + kWaitingLineEveryNs;
    while (next_cycle()) {
      const auto missing = monitor_.not_ready(names_);
      if (missing.empty()) return true;
      const std::int64_t now_ns = runtime::monotonic_now_ns();
      if (now_ns >= line_ns) {
        line_ns += kWaitingLineEveryNs;
        log_ << "palpate: "
             << waiting_line(monitor_.waited_for(names_), !options_.secure.empty(),
                             bus_.packets_refused())
             << std::endl;
      }
      if (!options_.everywhere.empty() || now_ns < deadline_ns) continue;
      log_ << fmt::format("palpate: not ready after {:g} s: {}\n", options_.ready_deadline,
                          fmt::join(monitor_.waited_for(names_), ", "));
      exit_code_ = kExitFailed;
      return false;
    }
    return false;
  }

  /// Simulated time that every process has done.
  std::int64_t slowest_ns() const {
    std::int64_t slowest = end_ns();
    for (const auto& name : names_) slowest = std::min(slowest, done_ns(name));
    return slowest;
  }
  std::int64_t done_ns(const std::string& name) const {
    const ModuleTally* module = monitor_.tally().module(name);
    return module == nullptr ? 0 : module->newest.header.sim_time_ns;
  }

  std::string waited_for() const {
    std::string waited;
    for (const auto& name : names_) {
      if (done_ns(name) == slowest_ns()) waited += (waited.empty() ? "" : " ") + name;
    }
    return "waiting for " + waited;
  }

  void grant() {
    const std::int64_t piece = ns_from_seconds(kGrant);
    const std::int64_t until = std::min(end_ns(), slowest_ns() / piece * piece + 2 * piece);
    if (until > session_.state().granted_until_ns()) conductor_.grant(session_.state(), until);
  }

  int end(bool complete, double wall_time = 0) {
    conductor_.command(session_.state(), SessionCommand::kStop);
    const bool window = complete && window_stays(options_) && modules_.running("visualizer");
    const auto any_running = [&] { return any_running_but(window ? "visualizer" : ""); };
    const std::int64_t deadline_ns = runtime::monotonic_now_ns() + kGoodbyeNs;
    while (complete && any_running() && runtime::monotonic_now_ns() < deadline_ns &&
           !stop_.requested()) {
      monitor_.wait(kLongestWait);
      monitor_.poll();
      for (const auto& ended : modules_.poll()) {
        if (ended.failed) failures_[ended.module] = ended.how;
      }
    }
    if (complete && any_running() && !stop_.requested()) {
      log_ << "palpate: a process has not ended within 10 s of the session; a recording may lack "
              "its last samples\n";
      exit_code_ = kExitFailed;
    }
    modules_.stop_all_but(window && !stop_.requested() ? "visualizer" : "");
    monitor_.poll();
    if (options_.snapshot_at) unite_parts();
    if (wall_time > 0) {
      SessionEnd said{scene_.name, seconds_from_ns(slowest_ns() - start_ns_),
                      wall_time,   modules_.last_words(),
                      failures_,   true};
      write_summary(said);
    }
    if (modules_.running("visualizer")) wait_for_window();
    if (exit_code_ != kExitDone) return exit_code_;
    return failures_.empty() ? kExitDone : kExitFailed;
  }

  bool any_running_but(const std::string& one) {
    return std::ranges::any_of(modules_.modules(), [&](const std::string& module) {
      return module != one && modules_.running(module);
    });
  }

  /// What was computed stays to be looked at, until the person closes it.
  void wait_for_window() {
    log_ << kWindowStays << std::flush;
    cores_.reset();
    while (!stop_.requested() && modules_.running("visualizer")) {
      monitor_.wait(kLongestWait);
      for (const auto& ended : modules_.poll()) {
        if (ended.failed) failures_[ended.module] = ended.how;
      }
    }
    modules_.stop();
  }

  /// A part may be there before the others have come so far.
  void unite_parts() {
    const double reached = seconds_from_ns(slowest_ns());
    const bool passed = slowest_ns() >= ns_from_seconds(*options_.snapshot_at);
    if (!passed || !unite_snapshot(options_, names_, scene_, log_)) {
      const int code = tell_no_snapshot(options_, reached, log_);
      if (exit_code_ == kExitDone) exit_code_ = code;
    }
    remove_snapshot_parts(options_, names_);
  }

  void write_summary(const SessionEnd& said) {
    write_run_summary(options_, summary(monitor_.tally(), said), out_);
  }

  const RunOptions& options_;
  std::ostream& out_;
  std::ostream& log_;
  StopSignal stop_;
  /// It is handed on some thousand times a second, each time to who sleeps.
  std::optional<runtime::AwakeCores> cores_;
  scene::Scene scene_;
  std::string digest_;
  double duration_;
  std::int64_t start_ns_;
  ModuleGroup modules_;  // before the bus: processes are born from a program of one thread
  std::vector<std::string> names_;
  bus::DdsBus bus_;
  runtime::Session session_;
  runtime::SessionConductor conductor_;
  bus::Writer<SceneDescription> scenes_;
  SessionMonitor monitor_;
  int exit_code_ = kExitDone;
  std::map<std::string, std::string> failures_;
};

/// This host's part of a lockstep that another one conducts.
int follow_lockstep(const RunOptions& options, std::ostream& log) {
  const StopSignal stop;
  const scene::Scene scene = scene::load_scene(options.scene);
  const std::size_t processes = scene::process_count(scene);
  ModuleGroup modules(module_commands(options, program_folder(), processes), log,
                      Restarting::kNever, options.folder);
  log << fmt::format("palpate: session {} of scene {}, in lockstep that another host conducts\n",
                     options.bus.session, scene.name)
      << std::flush;
  runtime::PeriodicLoop loop(1 / kLongestWait);
  int exit_code = kExitDone;
  while (modules.any_running() && !stop.requested()) {
    loop.wait_for_period();
    for (const auto& ended : modules.poll()) {
      if (!ended.failed) continue;
      exit_code = ended.bad_input ? kExitBadInput : kExitFailed;
      log << fmt::format("palpate: {} ended: {}; a lockstep session cannot go on without it\n",
                         ended.module, ended.how);
    }
  }
  modules.stop();
  return exit_code;
}

}  // namespace

/// Two lockstep runs of one session would take each other's samples for their own, and no stranger
/// can follow one: each has a name that nobody else has. Over hosts all say the same one.
int run_lockstep(const RunOptions& options, std::ostream& out, std::ostream& log) {
  if (!options.conducts) return follow_lockstep(options, log);
  if (!options.everywhere.empty()) return LockstepRun(options, out, log).perform();
  RunOptions own = options;
  own.bus.session += "-" + random_session_name();
  return LockstepRun(own, out, log).perform();
}

int run_in_process(const RunOptions& options, std::ostream& out, std::ostream& log) {
  const StopSignal stop;
  const scene::Scene scene = scene::load_scene(options.scene);
  const double duration = duration_of(options, scene);
  const runtime::Snapshot start = start_of(options, scene);
  check_times(options, start.time_ns, duration);
  runtime::WorkerTeam team(scene.deformation_threads);
  session::InProcessOptions wanted;
  wanted.runner = &team;
  wanted.from = &start;
  wanted.from_file = options.from_snapshot;
  session::InProcess session(scene, session::load_assets(scene, resampling_on(log)), wanted);
  auto scenes = session.bus().writer(bus::kScene);
  SceneDescription description = runtime::scene_description(scene);
  description.header.source_time_ns = runtime::CycleGrid::kSetUp;
  scenes.write(description);
  if (!options.record.empty()) {
    session.add("recorder", [&](bus::Bus& bus) {
      return std::make_unique<recording::RecorderStage>(
          bus, options.record, recording::TopicSelection(options.record_topics));
    });
  }
  SessionTally tally(scene);
  log << fmt::format("palpate: scene {} in one process\n", scene.name);
  Progress progress(start.time_ns, duration, out);
  bool save = options.snapshot_at.has_value();
  const auto instant = [&](double time) {
    return runtime::snapshot_time(scene, ns_from_seconds(time));
  };
  const std::int64_t save_at_ns = instant(options.snapshot_at.value_or(0));
  const auto save_if_due = [&] {
    if (!save || instant(session.time()) < save_at_ns) return;
    runtime::Snapshot snapshot = session.snapshot();
    snapshot.time_ns = save_at_ns;
    runtime::write_snapshot(options.snapshot, scene, snapshot);
    tell_snapshot(options, snapshot.time_ns, log);
    save = false;
  };
  while (session.time() < duration && !stop.requested()) {
    save_if_due();
    session.tick();
    for (const auto& [module, health] : session.healths()) {
      if (*health.guard != '\0') tally.note_degraded(module, health.guard);
    }
    progress.tell(session.time(), "");
  }
  save_if_due();
  const double reached = std::min(duration, session.time());
  session.finish(reached);
  tally.receive(session.contact_troubles());
  for (const auto& [module, health] : session.healths()) {
    tally.receive(health.organs);
    tally.receive(health.probes);
  }
  const SessionEnd said{
      scene.name, reached - seconds_from_ns(start.time_ns), progress.wall_time(), {}, {}, true};
  write_run_summary(options, summary(tally, said), out);
  return save ? tell_no_snapshot(options, reached, log) : kExitDone;
}

}  // namespace palpate::launcher
