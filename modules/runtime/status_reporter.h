// Tells the others how a module is: module_status, four times a second and on every change.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "modules/bus/bus.h"
#include "modules/runtime/periodic_loop.h"

namespace palpate::runtime {

/// Runs in the module's own loop: it allocates nothing after construction, and writing a status
/// neither blocks nor waits (topic kind "state" keeps the newest only). DDS takes a dozen small
/// blocks for a reliable sample: four times a second, not every cycle.
class StatusReporter {
 public:
  /// Reports on every reader of the bus but those of the session's own topics; of readers that are
  /// gone, the last numbers.
  StatusReporter(bus::Bus& bus, std::string module, double nominal_rate_hz, bool realtime_priority);

  /// @param error  shown until another state or error is set; cut at kMaxErrorBytes
  void set_state(ModuleState state, std::string_view error = {});
  void set_realtime_priority(bool granted) { status_.realtime_priority = granted; }
  void set_contact_troubles(const ContactTroubles& troubles) { status_.contacts = troubles; }
  /// At most one of each organ and probe of the scene.
  void set_extremes(std::span<const OrganExtremes> organs, std::span<const ProbeExtremes> probes);
  void set_real_time_factor(double factor) { status_.real_time_factor = factor; }

  /// Publishes if it is time to, or if the state changed since: then true.
  bool poll(std::int64_t now_ns, double session_time, const LoopStatistics& loop);
  /// Publishes now.
  void publish(std::int64_t now_ns, double session_time, const LoopStatistics& loop);

  /// Gives the last status time to be heard, at most kFarewell.
  void take_leave() { writer_.wait_until_received(kFarewell); }

  const ModuleStatus& status() const { return status_; }

  static constexpr std::size_t kMaxErrorBytes = 500;
  static constexpr double kFarewell = 0.2;  ///< [s]

 private:
  void count_cycles(std::int64_t now_ns, const LoopStatistics& loop);
  void fill_inputs(std::int64_t now_ns);
  ModuleStatus::Input* entry(std::string_view topic);

  bus::Writer<ModuleStatus> writer_;
  ModuleStatus status_;
  const bus::Bus& bus_;
  bool changed_ = true;
  bool told_refused_ = false;  ///< that the bus takes no status
  std::int64_t published_ns_ = 0;
  std::int64_t measured_ns_ = 0;  ///< since when cycles are counted for rate and busy fraction
  std::uint64_t cycles_then_ = 0;
  std::int64_t busy_then_ns_ = 0;
};

}  // namespace palpate::runtime
