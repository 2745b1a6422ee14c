#include "modules/runtime/lockstep_module.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>

#include "modules/bus/dds_bus.h"
#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/lockstep.h"
#include "modules/runtime/realtime.h"
#include "modules/runtime/session.h"
#include "modules/runtime/snapshot.h"
#include "modules/runtime/status_reporter.h"
#include "modules/runtime/time_histogram.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/processes.h"
#include "modules/scene/scene_reader.h"

namespace palpate::runtime {
namespace {

constexpr std::int64_t kWaitingLineEveryNs = 5 * kNanosecondsPerSecond;
constexpr double kLongestWait = 0.02;  ///< before signals and commands are looked at again [s]

bus::BusOptions lockstep_options(bus::BusOptions options, const std::string& name) {
  options.participant_name = name;
  options.every_sample = true;
  return options;
}

class LockstepModule {
 public:
  LockstepModule(const ModuleOptions& options, const scene::Scene& scene, const std::string& name,
                 const MakeStage& make)
      : options_(options),
        scene_(scene),
        name_(name),
        participants_(options.lockstep),
        bus_(lockstep_options(options.bus, name), bus::Arrivals::kPolled),
        session_(bus_, scene::scene_digest(scene), Session::Kind::kLockstep),
        status_(bus_, name, rate_of(name, scene), false) {
    if (std::ranges::find(participants_, name) == participants_.end()) {
      throw InputError("--lockstep: " + name + " itself is not among its modules");
    }
    bus_.set_clock([this] { return clock_ns_; });
    const std::size_t drivers_own = bus_.inputs().size();
    outputs_before_ = bus_.outputs().size();
    stage_ = make(bus_);
    const auto inputs = bus_.inputs().subspan(drivers_own);
    cursor_.emplace(scene, name, std::vector<bus::Input*>(inputs.begin(), inputs.end()));
    if (options.snapshot_at) {
      save_at_ns_ = snapshot_time(scene, ns_from_seconds(*options.snapshot_at));
    }
    if (options.from_snapshot.empty()) return;
    const Snapshot from = read_snapshot(options.from_snapshot, scene);
    go_on_from(from, options.from_snapshot, name, *cursor_, *stage_, own_outputs());
    start_ns_ = said_ns_ = from.time_ns;
  }

  void run() {
    // Who is ready plays: the scene is heard first.
    while (goes_on() && !(session_.knows_scene() && all_matched())) wait_for_command();
    say(ModuleState::kReady, start_ns_);
    while (goes_on()) work();
    if (session_.phase() == SessionPhase::kStopped) finish();
    say(ModuleState::kStopped, cursor_->next_ns());
    status_.take_leave();
    constexpr double kTenth = 0.1, kHalf = 0.5;
    spdlog::info(
        "{} cycles in lockstep, {:.3f} s simulated; from one to the next {:.3f} ms in the "
        "median, {:.3f} ms in the fastest tenth",
        loop_.cycles, seconds_from_ns(cursor_->next_ns()), 1e3 * cycle_times_.quantile(kHalf),
        1e3 * cycle_times_.quantile(kTenth));
    if (session_.phase() == SessionPhase::kStopped && stage_->stays()) stay();
  }

 private:
  /// Sockets are read while a command is waited for: the others leave once they are acknowledged.
  void stay() {
    const std::int64_t end_ns = cursor_->next_ns();
    while (!stop_.requested() && !finished_) {
      wait_for_command();
      finished_ = stage_->cycle({.sim_time_ns = end_ns, .now_ns = end_ns}).finished;
    }
  }

  bool goes_on() {
    session_.poll();
    if (!session_.fault().empty()) {
      say(ModuleState::kFault, cursor_->next_ns(), session_.fault());
      throw InputError(session_.fault());
    }
    return !stop_.requested() && !finished_ && session_.phase() != SessionPhase::kStopped;
  }

  bool all_matched() const {
    for (const bus::Output* output : bus_.outputs()) {
      if (output->matched_readers() < reader_count(output->topic().name, participants_)) {
        return false;
      }
    }
    return true;
  }

  /// Cycles until the grant is used up or an input is missing; then waits a moment for more.
  void work() {
    const std::int64_t until_ns = session_.state().granted_until_ns();
    bus::Input* missing = nullptr;
    while (cursor_->next_ns() < until_ns && (missing = cursor_->missing()) == nullptr) {
      save_if_due(cursor_->next_ns());
      clock_ns_ = cursor_->next_ns();
      const Health health = cursor_->step(*stage_);
      ++loop_.cycles;
      const std::int64_t done_ns = monotonic_now_ns();
      if (loop_.cycles > 1) cycle_times_.add(done_ns - done_ns_);
      done_ns_ = done_ns;
      wait_until_states_are_heard();
      if (is_awaited(name_, clock_ns_, scene_, participants_)) bus_.flush();
      if (*health.guard != '\0') guard_ = health.guard;
      status_.set_contact_troubles(health.contacts);
      status_.set_extremes(health.organs, health.probes);
      finished_ = health.finished;
      if (finished_ || stop_.requested()) break;
    }
    bus_.flush();
    if (finished_ || stop_.requested()) return;
    if (cursor_->next_ns() >= until_ns && said_ns_ < until_ns) {
      const bool guarded = *guard_ != '\0';
      say(guarded ? ModuleState::kDegraded : ModuleState::kRunning, until_ns, guard_);
      said_ns_ = until_ns;
      guard_ = "";
    }
    if (missing == nullptr) return wait_for_command();
    // A snapshot that is due holds the stage as it is before.
    if (!save_at_ns_) missing = cursor_->prepare(*stage_, *missing);
    if (missing != nullptr) wait_for(*missing);
  }

  /// Says every few seconds what it is that does not come.
  void wait_for(bus::Input& missing) {
    const std::int64_t now_ns = monotonic_now_ns();
    if (waits_at_ns_ != cursor_->next_ns()) waiting_since_ns_ = now_ns;
    waits_at_ns_ = cursor_->next_ns();
    if (now_ns - waiting_since_ns_ > kWaitingLineEveryNs) {
      spdlog::info("at {:.3f} s, waiting for {}", seconds_from_ns(waits_at_ns_),
                   missing.topic().name);
      waiting_since_ns_ = now_ns;
    }
    missing.wait(kLongestWait);
  }

  /// Everything that was said before the end is waited for, unless a signal comes.
  void finish() {
    const std::int64_t end_ns = session_.state().granted_until_ns();
    while (bus::Input* missing = cursor_->missing_before_end(end_ns)) {
      if (stop_.requested()) return;
      missing->wait(kLongestWait);
    }
    save_if_due(snapshot_time(scene_, end_ns));
    cursor_->finish(*stage_, end_ns);
    wait_until_heard();
  }

  std::span<bus::Output* const> own_outputs() const {
    return bus_.outputs().subspan(outputs_before_);
  }

  /// Once all cycles before the snapshot's time are done, and all that was said before it is here.
  void save_if_due(std::int64_t now_ns) {
    if (!save_at_ns_ || now_ns < *save_at_ns_) return;
    Snapshot own{*save_at_ns_};
    save_at_ns_.reset();
    add_to(own, name_, *cursor_, *stage_, own_outputs());
    write_snapshot(options_.snapshot, scene_, own);
  }

  /// A writer that leaves takes along what a reader has not yet got: one that was stopped for a
  /// while would wait for it in vain. A signal ends it.
  void wait_until_heard() {
    for (bus::Output* output : bus_.outputs()) {
      while (!stop_.requested() && !output->raw().wait_until_received(kLongestWait)) {
      }
    }
  }

  static bool is_state_of_wires(const bus::Output& output) {
    const bus::TopicInfo& topic = output.topic();
    return topic.delivery == bus::Delivery::kState && find_wire(topic.name) != nullptr;
  }

  /// What a state says now, a reader may need by the next cycle, and no cycle waits for it: a mesh
  /// is told once, an advance before node positions are of it.
  void wait_until_states_are_heard() {
    std::uint64_t said = 0;
    for (const bus::Output* output : bus_.outputs()) {
      if (is_state_of_wires(*output)) said += output->next_sequence();
    }
    if (said == states_heard_) return;  // DDS is asked under its locks
    states_heard_ = said;
    for (bus::Output* output : bus_.outputs()) {
      if (!is_state_of_wires(*output)) continue;
      while (!stop_.requested() && !output->raw().wait_until_received(kLongestWait)) {
      }
    }
  }

  void wait_for_command() { session_.wait(kLongestWait); }

  void say(ModuleState state, std::int64_t sim_time_ns, std::string_view error = {}) {
    status_.set_state(state, error);
    status_.publish(monotonic_now_ns(), seconds_from_ns(sim_time_ns), loop_);
  }

  const ModuleOptions& options_;
  const scene::Scene& scene_;
  std::string name_;
  std::vector<std::string> participants_;
  StopSignal stop_;
  std::int64_t clock_ns_ = CycleGrid::kSetUp;
  bus::DdsBus bus_;
  Session session_;
  StatusReporter status_;
  std::unique_ptr<Stage> stage_;
  std::optional<LockstepCursor> cursor_;
  LoopStatistics loop_;
  TimeHistogram cycle_times_;       ///< from the end of one to the end of the next, by the wall
  std::int64_t done_ns_ = 0;        ///< the last one
  std::size_t outputs_before_ = 0;  ///< the stage's own
  std::uint64_t states_heard_ = 0;  ///< sum of their numbers
  std::int64_t start_ns_ = 0;
  std::optional<std::int64_t> save_at_ns_;  ///< none: no snapshot, or it is written
  std::int64_t said_ns_ = 0;
  std::int64_t waits_at_ns_ = CycleGrid::kSetUp, waiting_since_ns_ = 0;
  const char* guard_ = "";
  bool finished_ = false;
};

/// Of several processes of deformation, which compute at the same time.
void share_cores(const scene::Scene& scene, const std::string& module) {
  const std::size_t processes = scene::process_count(scene);
  if (processes == 1) return;
  // Who is told second must not wait until the first is done.
  wait_for_turn();
  const auto named = module_named(module);
  if (scene.deformation_threads == 1 && named && named->job == "deformation") {
    keep_to_own_core(named->process - 1, processes);
  }
}

}  // namespace

void run_in_lockstep(const ModuleOptions& options, const scene::Scene& scene,
                     const std::string& module, const MakeStage& make) {
  share_cores(scene, module);
  LockstepModule(options, scene, module, make).run();
}

}  // namespace palpate::runtime
