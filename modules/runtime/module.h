// What all modules have in common: priority, bus, session, loop and status, in the right order.
#pragma once

#include <memory>
#include <string>

#include "modules/bus/dds_bus.h"
#include "modules/core/stop_signal.h"
#include "modules/runtime/module_options.h"
#include "modules/runtime/periodic_loop.h"
#include "modules/runtime/realtime.h"
#include "modules/runtime/session.h"
#include "modules/runtime/status_reporter.h"
#include "modules/scene/scene.h"

namespace palpate::runtime {

/// How a module shares the processor.
enum class Priority {
  kRealtime,   ///< SCHED_FIFO and locked memory where granted; a warning where not
  kPreferred,  ///< SCHED_FIFO below it, given up by a loop that is busy all the time
  kBackground  ///< gives way to the others
};

/// One module's life: construct, make the stage on its bus, ready(), then
/// while (next_cycle()) { … }.
class Module {
 public:
  Module(const ModuleOptions& options, const scene::Scene& scene, std::string name, double rate_hz,
         Priority priority);
  ~Module();  ///< says goodbye: state kStopped, and one line of loop statistics in the log

  bus::Bus& bus() { return bus_; }

  /// Everything is loaded: the session may start.
  void ready();

  /// Waits for the next period, follows the session and publishes the status. False when a signal
  /// or the session says stop. Never throws; allocates and logs nothing but what StatusReporter
  /// says and, once, that a priority is given back. Who joins a session that runs
  /// (ModuleOptions::joins) gets its first one when a command was heard, or a second has passed.
  bool next_cycle();

  /// Waits for the next period, whatever was said: for a stage that takes leave.
  void wait_for_period() {
    while (!loop_.wait_for_period()) {
    }
  }

  std::int64_t now_ns() const { return loop_.woke_ns(); }  ///< when this cycle began
  double period() const;                                   ///< [s]
  /// Session time of this cycle [s].
  double time() const { return session_.time(now_ns()); }
  bool running() const { return session_.running() && !session_.state().halted(now_ns()); }
  bool take_reset() { return session_.take_reset(); }
  /// The session ran, or stood, before the first cycle; known of who joins (ModuleOptions::joins).
  bool joined() const { return joined_; }
  const Session& session() const { return session_; }

  /// Guards that act in this cycle, for the status; empty if none. A pointer to a constant text.
  void set_guard(const char* acting) { guard_ = acting; }
  void set_real_time_factor(double factor) { status_.set_real_time_factor(factor); }
  void set_contact_troubles(const ContactTroubles& troubles) {
    status_.set_contact_troubles(troubles);
  }
  void set_extremes(std::span<const OrganExtremes> organs, std::span<const ProbeExtremes> probes) {
    status_.set_extremes(organs, probes);
  }

  /// A header for a message of this cycle.
  Header header() const;

 private:
  bool knows_time() const;
  void report_state();
  void give_way_if_busy();
  void run_with_priority();

  std::string name_;
  Priority priority_;
  bool joins_, joined_ = false;
  StopSignal stop_;
  Realtime realtime_;
  std::unique_ptr<AwakeCores> cores_;  ///< none: it does not ask
  bus::DdsBus bus_;
  Session session_;
  PeriodicLoop loop_;
  StatusReporter status_;
  std::int64_t began_ns_;
  const char* guard_ = "";
  std::int64_t guard_since_ns_ = 0;
  bool ready_ = false;
  bool ran_ = false;                  ///< the session has
  std::int64_t judged_since_ns_ = 0;  ///< how busy the loop is; then its time in cycles so far
  std::int64_t busy_then_ns_ = 0;
};

}  // namespace palpate::runtime
