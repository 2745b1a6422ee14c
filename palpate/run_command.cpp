#include "palpate/run_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "modules/bus/dds_bus.h"
#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/core/output_file.h"
#include "modules/core/stop_signal.h"
#include "modules/core/temporary_folder.h"
#include "modules/core/units.h"
#include "modules/core/whole_file.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/periodic_loop.h"
#include "modules/runtime/session.h"
#include "modules/runtime/stage.h"
#include "modules/scene/processes.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/settings.h"
#include "palpate/hang_watch.h"
#include "palpate/known_names.h"
#include "palpate/lockstep_run.h"
#include "palpate/module_group.h"
#include "palpate/run_snapshot.h"
#include "palpate/scene_doubts.h"
#include "palpate/session_claim.h"
#include "palpate/session_monitor.h"
#include "palpate/session_text.h"

namespace palpate::launcher {
namespace {

/// How often processes, statuses and signals are looked at [Hz].
constexpr double kRate = 100;
constexpr std::int64_t kLineEveryNs = kNanosecondsPerSecond;
/// A session that already runs has been heard by then: twice the longest discovery measured.
constexpr std::int64_t kDiscoveryNs = kNanosecondsPerSecond / 2;
/// With keys each pair has to prove who it is first.
constexpr std::int64_t kSecureDiscoveryNs = 3 * kNanosecondsPerSecond;

/// One run from start to summary.
class Run {
 public:
  Run(const RunOptions& options, SessionClaim claim, std::ostream& out, std::ostream& log)
      : options_(options),
        claim_(std::move(claim)),
        out_(out),
        log_(log),
        scene_(scene::load_scene(options.scene)),
        digest_(scene::scene_digest(scene_)),
        modules_(module_commands(options, program_folder(), scene::process_count(scene_)), log,
                 options.restart ? Restarting::kWithPauses : Restarting::kNever, options.folder),
        bus_(options.bus),
        session_(bus_, digest_),
        conductor_(bus_),
        scenes_(bus_.writer(bus::kScene)),
        monitor_(bus_, scene_),
        loop_(kRate) {}

  int perform() {
    if (options_.only.empty()) tell_scene();
    log_ << fmt::format("palpate: session {} of scene {}\n", options_.bus.session, scene_.name);
    if (wait_until_ready()) {
      start();
      while (next_cycle() && !is_over()) report_each_second();
    }
    finish();
    if (!refusal_.empty()) throw InputError(refusal_);
    return exit_code_;
  }

 private:
  /// One round of listening. False when a signal says stop or no module is left.
  bool next_cycle() {
    loop_.wait_for_period();
    session_.poll();
    repeat_new_command();
    if (session_.phase() == runtime::SessionPhase::kPaused) stood_ns_ = loop_.woke_ns();
    monitor_.tally().stands(stood_ns_ != 0 &&
                            loop_.woke_ns() - stood_ns_ < runtime::kGoesOnWithinNs);
    monitor_.poll();
    for (const auto& line : monitor_.take_warnings()) {
      log_ << "palpate: warning: " << line << std::endl;
    }
    if (suspension_.take()) {
      log_ << "palpate: Ctrl-Z stops no session, for its processes would go on pushing: Ctrl-C "
              "ends it, space in its window pauses it"
           << std::endl;
    }
    if (options_.restart && !ended_) end_hung();
    for (const auto& end : modules_.poll()) note(end);
    return !stop_.requested() && modules_.any_running();
  }

  /// Somebody else's, who may leave before all have heard it: whoever comes hears the launcher's.
  void repeat_new_command() {
    const std::int64_t said_ns = session_.state().last_command().header.source_time_ns;
    if (std::exchange(repeated_ns_, said_ns) == said_ns || !goes_on() || joined_) return;
    conductor_.repeat(session_.state());
  }

  void tell_scene() {
    scene_told_ = true;
    SceneDescription description = runtime::scene_description(scene_);
    scenes_.write(description);
  }

  /// Whoever starts part of a session tells it no scene that it does not play.
  /// @returns false if it plays another
  bool joins() {
    if (scene_told_) return true;
    if (!session_.fault().empty()) {
      refusal_ = options_.scene.string() + ": " + session_.fault();
      joined_ = true;  // the session goes on without us
      return false;
    }
    tell_scene();
    return true;
  }

  /// False if the session cannot start.
  bool wait_until_ready() {
    auto expected = modules_.reporting_modules();
    if (options_.conducts && !options_.everywhere.empty()) expected = options_.everywhere;
    const bool records = std::ranges::find(expected, "recorder") != expected.end();
    // Alone it waits for nobody, and says nothing.
    if (!records && !expected.empty() && modules_.running("recorder"))
      expected.emplace_back("recorder");
    const std::int64_t begin_ns = runtime::monotonic_now_ns();
    const std::int64_t heard_ns = options_.secure.empty() ? kDiscoveryNs : kSecureDiscoveryNs;
    const std::int64_t earliest_ns = begin_ns + (options_.only.empty() ? 0 : heard_ns);
    std::int64_t line_ns = begin_ns + kWaitingLineEveryNs;
    while (next_cycle()) {
      if (loop_.woke_ns() >= earliest_ns && !joins()) return false;
      if (recorder_left_) std::erase(expected, "recorder");
      auto waiting = monitor_.not_ready(expected);
      const bool started = session_.phase() != runtime::SessionPhase::kWaiting;
      if (!options_.conducts && !started) waiting.emplace_back("the host that starts the session");
      if (waiting.empty() && loop_.woke_ns() >= earliest_ns) return true;
      if (exit_code_ != kExitDone) return false;
      if (waiting.empty() || loop_.woke_ns() < line_ns) continue;
      line_ns += kWaitingLineEveryNs;
      log_ << "palpate: "
           << waiting_line(monitor_.waited_for(waiting), !options_.secure.empty(),
                           bus_.packets_refused())
           << std::endl;
    }
    return false;
  }

  void start() {
    began_ns_ = line_ns_ = stood_ns_ = loop_.woke_ns();
    joined_ = session_.phase() != runtime::SessionPhase::kWaiting;
    if (!joined_) {
      if (!options_.only.empty()) log_ << "palpate: starts the session, and ends it\n";
      conductor_.command(session_.state(), SessionCommand::kStart);
    } else {
      joined_at_ = session_.time(loop_.woke_ns());
      log_ << "palpate: joining the session that already runs\n";
    }
    monitor_.tally().start();
  }

  bool is_over() {
    // A scene's is its session's: whoever conducts that ends it.
    double duration = options_.duration;
    if (duration <= 0 && !joined_) duration = scene_.duration;
    const double run = session_.time(loop_.woke_ns()) - joined_at_;
    const bool duration_reached = duration > 0 && run >= duration;
    return duration_reached || session_.phase() == runtime::SessionPhase::kStopped;
  }

  void report_each_second() {
    if (session_.take_reset() && session_.phase() == runtime::SessionPhase::kWaiting) {
      conductor_.command(session_.state(), SessionCommand::kStart);
    }
    if (loop_.woke_ns() - line_ns_ < kLineEveryNs) return;
    line_ns_ += kLineEveryNs;
    if (!joined_) conductor_.repeat(session_.state());
    std::vector<std::string> away = monitor_.silent();
    for (const auto& name : modules_.modules()) {
      if (!modules_.running(name)) away.push_back(name);
    }
    out_ << status_line(monitor_.tally(), session_.time(loop_.woke_ns()), away) << std::endl;
  }

  void end_hung() {
    for (const auto& name : modules_.modules()) {
      if (!modules_.running(name)) continue;
      const pid_t process = modules_.process_id(name);
      const double silent =
          hangs_.hangs_for(fmt::format("{} {}", name, process), last_word(name, process),
                           modules_.computed(name), loop_.woke_ns());
      if (silent > 0) modules_.kill_hung(name, fmt::format("said nothing for {:.0f} s", silent));
    }
  }

  /// What changes as long as a process lives: its status counts up; a recorder, which has none,
  /// takes a little of the processor's time again and again.
  std::uint64_t last_word(const std::string& name, pid_t process) const {
    const auto reporting = modules_.reporting_modules();
    if (std::ranges::find(reporting, name) == reporting.end()) {
      return 1 + static_cast<std::uint64_t>(1e9 * modules_.computed(name));
    }
    const ModuleTally* module = monitor_.tally().module(name);
    const bool its_own = module != nullptr && module->newest.process_id == process;
    return its_own ? module->newest.header.sequence : 0;
  }

  void note(const ModuleEnd& end) {
    if (!end.returns) claim_.release(end.module);
    if (end.failed && !end.returns) {
      exit_code_ = end.bad_input ? kExitBadInput : kExitFailed;
      failures_[end.module] = end.how;
    }
    if (end.module == "recorder" && !ended_) {
      recorder_left_ = !end.returns;
      recording_end_ = fmt::format("ended {:.1f} s into the session",
                                   session_.time(runtime::monotonic_now_ns()));
      if (!end.last_error.empty()) recording_end_ += "; it said: " + end.last_error;
    }
    log_ << fmt::format("palpate: {} ended: {}", end.module, end.how);
    if (!end.last_error.empty()) log_ << fmt::format("; it said: {}", end.last_error);
    log_ << std::endl;
    if (!goes_on() || end.returns || !modules_.any_running()) return;
    const bool is_disk_full = end.module == "recorder" && !end.failed && !end.last_error.empty();
    log_ << "palpate: the rest goes on; "
         << (is_disk_full ? "free space first, then part 2 is recorded by: "
                          : "to start it again: ")
         << end.start_again << std::endl;
  }

  void finish() {
    ended_ = true;
    const std::int64_t now = runtime::monotonic_now_ns();
    SessionEnd end{scene_.name, session_.time(now), 0, {}, failures_, false};
    if (begun()) end.wall_time = seconds_from_ns(now - began_ns_);
    const bool window = begun() && window_stays(options_) && !joined_ && !stop_.requested() &&
                        session_.phase() != runtime::SessionPhase::kStopped &&
                        modules_.running("visualizer");
    if (!joined_) {
      conductor_.command(session_.state(), window ? SessionCommand::kPause : SessionCommand::kStop);
    }
    const bool recorder_lives = modules_.running("recorder");
    modules_.stop_all_but(window ? "visualizer" : "");
    for (const auto& name : modules_.deaf()) {
      log_ << "palpate: " << name << " did not end when told, and was killed" << std::endl;
    }
    monitor_.poll();
    if (!begun()) return;
    judge_recording(recorder_lives);
    judge_pictures();
    end.failures = failures_;
    end.last_words = modules_.last_words();
    end.restarts = modules_.restarts();
    end.recording = recording_end_;
    const std::string text = summary(monitor_.tally(), end);
    write_run_summary(options_, text, out_);
    if (window) wait_for_window();
  }

  /// One that was started again, and lives, goes on with what another has left.
  void judge_recording(bool lived) {
    const auto end = modules_.last_end("recorder");
    if (!end) return;
    if (lived) recording_end_.clear();
    if (lived && (end->failed || !end->last_error.empty())) {
      recording_end_ = "not ended well: " + end->how;
      if (!end->last_error.empty()) recording_end_ += "; it said: " + end->last_error;
    }
    const bool gone = !options_.record.empty() && !std::filesystem::exists(options_.record);
    if (gone && !end->failed) {
      recording_end_ = fmt::format(
          "there is no {}: no sample found room in it; what came later is "
          "in a part of its own",
          options_.record.string());
    }
    if ((end->failed || gone) && exit_code_ == kExitDone) exit_code_ = kExitFailed;
  }

  /// It tells at its end of those that it could not write; of the first at once, for it may have to
  /// be killed within the next.
  void judge_pictures() {
    const auto end = modules_.last_end("visualizer");
    if (options_.frames.empty() || !end || !end->failed) return;
    if (end->killed && end->last_error.find("] error: ") == std::string::npos) return;
    failures_["visualizer"] = end->how;
    if (exit_code_ == kExitDone) exit_code_ = kExitFailed;
  }

  bool begun() const { return began_ns_ != 0; }
  bool goes_on() const { return begun() && !ended_; }

  /// What was felt stays to be looked at, until the person closes it.
  void wait_for_window() {
    log_ << kWindowStays << std::flush;
    while (next_cycle() && session_.phase() != runtime::SessionPhase::kStopped) {
    }
    conductor_.command(session_.state(), SessionCommand::kStop);
    modules_.stop();
    judge_pictures();
  }

  const RunOptions& options_;
  SessionClaim claim_;
  std::ostream& out_;
  std::ostream& log_;
  StopSignal stop_;
  NoSuspension suspension_;
  scene::Scene scene_;
  std::string digest_;
  ModuleGroup modules_;  // before the bus: processes are born from a program of one thread
  bus::DdsBus bus_;
  runtime::Session session_;
  runtime::SessionConductor conductor_;
  bus::Writer<SceneDescription> scenes_;
  SessionMonitor monitor_;
  runtime::PeriodicLoop loop_;
  std::int64_t began_ns_ = 0, line_ns_ = 0;
  std::int64_t repeated_ns_ = 0;  ///< when the command was given that was repeated last
  std::int64_t stood_ns_ = 0;     ///< when it was last paused or had not begun; 0: never
  bool scene_told_ = false;
  bool joined_ = false;         ///< another launcher conducts the session
  double joined_at_ = 0;        ///< the session's time then [s]; 0: it began with us
  bool ended_ = false;          ///< the run; its window may stay
  bool recorder_left_ = false;  ///< for good
  int exit_code_ = kExitDone;
  std::map<std::string, std::string> failures_;
  std::string refusal_;        ///< of another scene than the session's
  std::string recording_end_;  ///< where that came before the session's
  HangWatch hangs_;
};

}  // namespace

int run_command(const RunOptions& asked, std::ostream& out, std::ostream& log) {
  RunOptions options = asked;
  check_recording(options);
  check_snapshots(options);
  if (!options.summary.empty()) check_replaces_its_like(options.summary, "scene ", "summary");
  check_frames(options);
  if (options.everywhere.empty()) apply_hosts(options);  // once: it comes back with the settings
  if (!options.settings.empty()) {
    const StopSignal stop;         // or a signal would leave the folder
    const TemporaryFolder folder;  // each process reads the scene
    const scene::Scene scene = scene::load_scene_with(options.scene, options.settings);
    RunOptions changed = options;
    changed.settings.clear();
    changed.folder = folder.path();
    changed.scene = folder.write("scene.yaml", scene::resolved_text(scene));
    std::string known = options.scene.string() + " with";
    for (const std::string& setting : options.settings) known += " --set " + setting;
    KnownNames names;
    names.add(changed.scene, known);
    try {
      return run_command(changed, out, log);
    } catch (const InputError& error) {
      throw names.in(error);
    }
  }
  if (options.only.empty()) {
    const scene::Scene scene = scene::load_scene(options.scene);
    for (const auto& doubt :
         doubts_about(scene, load_skins(scene, resampling_on(log)), progress_on(log)).lines) {
      log << "palpate: warning: " << doubt << std::endl;
    }
  }
  if (options.in_process) return run_in_process(options, out, log);
  const auto commands = module_commands(options, program_folder(),
                                        scene::process_count(scene::load_scene(options.scene)));
  if (commands.empty()) {
    throw InputError(
        "--only: leaves nothing to start; a recorder needs --record, a visualizer a window, or "
        "--frames, and no --no-visualizer");
  }
  check_keys_of(commands);
  clear_frames(options);
  if (options.lockstep) return run_lockstep(options, out, log);
  std::vector<std::string> modules;
  for (const auto& command : commands) modules.push_back(command.module);
  const bool joins = !options.only.empty() && options.hosts.empty();
  const bus::BusOptions& bus = options.bus;
  return Run(options,
             joins ? SessionClaim::joining(bus.session, bus.domain, modules)
                   : SessionClaim(bus.session, bus.domain, modules),
             out, log)
      .perform();
}

}  // namespace palpate::launcher
