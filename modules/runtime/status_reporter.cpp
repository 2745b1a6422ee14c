#include "modules/runtime/status_reporter.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "modules/core/error.h"
#include "modules/core/text.h"
#include "modules/core/units.h"

namespace palpate::runtime {
namespace {
constexpr std::int64_t kStatusPeriodNs = kNanosecondsPerSecond / 4;
}

StatusReporter::StatusReporter(bus::Bus& bus, std::string module, double nominal_rate_hz,
                               bool realtime_priority)
    : writer_(bus.writer(bus::kModuleStatus)), bus_(bus) {
  status_.module = std::move(module);
  status_.process_id = getpid();
  status_.nominal_rate_hz = nominal_rate_hz;
  status_.realtime_priority = realtime_priority;
  status_.last_error.reserve(kMaxErrorBytes);
  status_.inputs.reserve(kMaxInputs);
  status_.organs.reserve(kMaxOrgans);
  status_.probes.reserve(kMaxProbes);
}

void StatusReporter::set_state(ModuleState state, std::string_view error) {
  error = cut_at_letter(error, kMaxErrorBytes);
  if (state == status_.state && error == status_.last_error) return;
  status_.state = state;
  status_.last_error.assign(error);
  changed_ = true;
}

void StatusReporter::set_extremes(std::span<const OrganExtremes> organs,
                                  std::span<const ProbeExtremes> probes) {
  status_.organs.assign(organs.begin(), organs.end());
  status_.probes.assign(probes.begin(), probes.end());
}

bool StatusReporter::poll(std::int64_t now_ns, double session_time, const LoopStatistics& loop) {
  if (!changed_ && now_ns - published_ns_ < kStatusPeriodNs) return false;
  publish(now_ns, session_time, loop);
  return true;
}

void StatusReporter::publish(std::int64_t now_ns, double session_time, const LoopStatistics& loop) {
  count_cycles(now_ns, loop);
  fill_inputs(now_ns);
  status_.packets_refused = bus_.packets_refused().count;
  status_.header.sim_time_ns = ns_from_seconds(session_time);
  status_.header.source_time_ns = now_ns;
  if (!writer_.write(status_) && !std::exchange(told_refused_, true)) {
    const char* const field = writer_.statistics().last_refused_field;
    spdlog::error("its status cannot be told: {}", field == nullptr ? "the bus refused it" : field);
  }
  published_ns_ = now_ns;
  changed_ = false;
}

void StatusReporter::count_cycles(std::int64_t now_ns, const LoopStatistics& loop) {
  // Changes of state are said at once: within a cycle, and after too few, this would be noise.
  if (measured_ns_ == 0 || now_ns - measured_ns_ >= kStatusPeriodNs) {
    const double elapsed = seconds_from_ns(now_ns - measured_ns_);
    if (measured_ns_ != 0) {
      const auto cycles = static_cast<double>(loop.cycles - cycles_then_);
      status_.rate_hz = cycles / elapsed;
      status_.busy_fraction = seconds_from_ns(loop.busy_ns - busy_then_ns_) / elapsed;
    }
    measured_ns_ = now_ns;
    cycles_then_ = loop.cycles;
    busy_then_ns_ = loop.busy_ns;
  }
  status_.cycles = loop.cycles;
  status_.overruns = loop.overruns;
  status_.worst_lateness = seconds_from_ns(loop.worst_lateness_ns);
}

void StatusReporter::fill_inputs(std::int64_t now_ns) {
  for (const bus::Input* input : bus_.inputs()) {
    const std::string_view topic = input->topic().name;
    if (topic == bus::kSessionControl.name || topic == bus::kScene.name) continue;
    const bus::ReaderStatistics& from = input->statistics();
    ModuleStatus::Input* to = entry(topic);
    if (to == nullptr) continue;
    // a sample may have been written after this cycle began
    const std::int64_t age_ns = std::max<std::int64_t>(0, now_ns - from.newest_source_time_ns);
    to->age = from.newest_source_time_ns == 0 ? std::numeric_limits<double>::infinity()
                                              : seconds_from_ns(age_ns);
    to->age_error = from.clock_error;
    to->received = from.received;
    to->dropped = from.dropped;
    to->rejected = from.rejected;
  }
}

ModuleStatus::Input* StatusReporter::entry(std::string_view topic) {
  for (ModuleStatus::Input& known : status_.inputs) {
    if (known.topic == topic) return &known;
  }
  if (status_.inputs.size() == kMaxInputs) return nullptr;
  status_.inputs.push_back({std::string(topic), 0, 0, 0, 0, 0});
  return &status_.inputs.back();
}

}  // namespace palpate::runtime
