#include "modules/runtime/module.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "modules/core/units.h"
#include "modules/runtime/clock.h"
#include "modules/scene/scene_reader.h"

namespace palpate::runtime {
namespace {

constexpr int kRealtimeFifo = 80;
constexpr int kPreferredFifo = 20;
/// Below its bus' threads, which would hear nothing while a loop on each core is busy.
constexpr int kPreferredLoopFifo = kPreferredFifo - 1;
/// A loop that works more than this part of its periods would keep everybody else, and by the
/// kernel's throttling even the haptic loop, from running.
constexpr double kBusyAllTheTime = 0.9;
/// What is judged at once: a single cycle that others kept from running says nothing.
constexpr std::int64_t kBusyJudgedNs = kNanosecondsPerSecond / 4;
constexpr int kBackgroundSteps = 10;
/// Who joins a session that nobody conducts takes part all the same.
constexpr std::int64_t kTimeHeardWithinNs = kNanosecondsPerSecond;
/// A guard that acted for a moment stays visible for this long.
constexpr std::int64_t kGuardShownNs = kNanosecondsPerSecond;

Realtime take_priority(Priority priority, bool realtime_wanted) {
  if (priority == Priority::kBackground) lower_priority(kBackgroundSteps);
  if (!realtime_wanted) return {};
  if (priority == Priority::kPreferred) return request_realtime(kPreferredFifo, false);
  if (priority != Priority::kRealtime) return {};
  Realtime granted = request_realtime(kRealtimeFifo, true);
  if (!granted.refused.empty()) spdlog::warn("{}", granted.refused);
  return granted;
}

std::unique_ptr<AwakeCores> cores_for(Priority priority, bool realtime_wanted) {
  if (!realtime_wanted || priority != Priority::kRealtime) return nullptr;
  auto cores = std::make_unique<AwakeCores>();
  if (const std::string refused = cores->refused(); !refused.empty()) spdlog::warn("{}", refused);
  return cores;
}

bus::BusOptions named(bus::BusOptions options, const std::string& name) {
  options.participant_name = name;
  return options;
}

}  // namespace

Module::Module(const ModuleOptions& options, const scene::Scene& scene, std::string name,
               double rate_hz, Priority priority)
    : name_(std::move(name)),
      priority_(priority),
      joins_(options.joins),
      realtime_(take_priority(priority, options.realtime)),
      cores_(cores_for(priority, options.realtime)),
      bus_(named(options.bus, name_)),
      session_(bus_, scene::scene_digest(scene)),
      loop_(rate_hz),
      status_(bus_, name_, rate_hz, realtime_.priority),
      began_ns_(monotonic_now_ns()) {
  if (realtime_.priority) give_up_realtime();
}

Module::~Module() {
  const std::int64_t now = monotonic_now_ns();
  const LoopStatistics& loop = loop_.statistics();
  const double worst = seconds_from_ns(loop.worst_lateness_ns);
  status_.set_state(ModuleState::kStopped, status_.status().last_error);
  status_.publish(now, session_.time(now), loop);
  status_.take_leave();
  spdlog::info(
      "{} cycles at {:.0f} Hz since its start, waiting for the session too: {:.3f} % on time, late "
      "by at most {:.3f} ms ({:.3f} ms in 99.9 %)",
      loop.cycles, loop_.rate_hz(), 100 * loop.on_time_fraction(), 1e3 * worst,
      1e3 * std::min(worst, loop.lateness.quantile(0.999)));
  if (const bus::Refusals refused = bus_.packets_refused(); refused.count > 0) {
    spdlog::warn("{} packets from outside the session refused, the last: {}", refused.count,
                 refused.last);
  }
}

void Module::ready() { ready_ = true; }

bool Module::next_cycle() {
  do {
    while (!loop_.wait_for_period() && !stop_.requested()) {
    }
    session_.poll();
  } while (!knows_time() && !stop_.requested());
  if (std::exchange(joins_, false)) joined_ = session_.phase() != SessionPhase::kWaiting;
  if (session_.running()) run_with_priority();
  report_state();
  give_way_if_busy();
  status_.poll(now_ns(), time(), loop_.statistics());
  return !stop_.requested() && session_.phase() != SessionPhase::kStopped;
}

bool Module::knows_time() const {
  return !joins_ || session_.state().last_command().header.source_time_ns != 0 ||
         now_ns() - began_ns_ > kTimeHeardWithinNs;
}

/// The bus' threads have had it since they were made; who loads or waits would keep other sessions
/// from starting.
void Module::run_with_priority() {
  if (std::exchange(ran_, true)) return;
  if (cores_) cores_->keep();
  if (!realtime_.priority) return;
  resume_realtime(priority_ == Priority::kRealtime ? kRealtimeFifo : kPreferredLoopFifo);
  judged_since_ns_ = now_ns();
  busy_then_ns_ = loop_.statistics().busy_ns;
}

void Module::report_state() {
  if (*guard_ != '\0') guard_since_ns_ = now_ns();
  if (!session_.fault().empty()) {
    status_.set_state(ModuleState::kFault, session_.fault());
  } else if (!ready_) {
    status_.set_state(ModuleState::kStarting);
  } else if (session_.phase() == SessionPhase::kWaiting) {
    status_.set_state(ModuleState::kReady);
  } else if (session_.phase() == SessionPhase::kPaused || session_.state().halted(now_ns())) {
    status_.set_state(ModuleState::kPaused);
  } else if (*guard_ != '\0') {
    status_.set_state(ModuleState::kDegraded, guard_);
  } else if (*bus_.clock_trouble() != '\0') {
    status_.set_state(ModuleState::kDegraded, bus_.clock_trouble());
  } else if (status_.status().state != ModuleState::kDegraded ||
             now_ns() - guard_since_ns_ > kGuardShownNs) {
    status_.set_state(ModuleState::kRunning);
  }
}

/// Judged by what it does with the priority: without one, time that others took counts as its own.
void Module::give_way_if_busy() {
  if (priority_ != Priority::kPreferred || !realtime_.priority || !ran_) return;
  const std::int64_t judged_ns = now_ns() - judged_since_ns_;
  if (judged_ns < kBusyJudgedNs) return;
  const double busy =
      seconds_from_ns(loop_.statistics().busy_ns - busy_then_ns_) / seconds_from_ns(judged_ns);
  judged_since_ns_ = now_ns();
  busy_then_ns_ = loop_.statistics().busy_ns;
  if (busy < kBusyAllTheTime) return;
  give_up_realtime();
  realtime_.priority = false;
  status_.set_realtime_priority(false);
  spdlog::info("busy {:.0f} % of the time: back to normal priority", 100 * busy);
}

double Module::period() const { return seconds_from_ns(loop_.period_ns()); }

Header Module::header() const {
  Header header;
  header.sim_time_ns = ns_from_seconds(time());
  header.source_time_ns = now_ns();
  return header;
}

}  // namespace palpate::runtime
