// A process without its loop: what a stage is told each cycle, and what it says of itself.
//
// A stage reads its inputs from a bus, works, and writes its outputs to it. It owns no loop, clock,
// thread or socket; a driver calls it: in real time (module.h), in lockstep between processes
// (lockstep.h), or with others in one process (palpate/session/in_process.h).
#pragma once

#include <cstdint>
#include <span>

#include "modules/core/state_archive.h"
#include "modules/core/units.h"
#include "modules/messages/messages.h"

namespace palpate::runtime {

/// Age from which an input no longer counts as telling the present [s].
inline constexpr double kInputStaleAfter = 0.05;

/// After a start, and after a pause, all have heard each other by then, and statuses say so: until
/// then what is stale or fades because of it is no trouble [ns].
inline constexpr std::int64_t kGoesOnWithinNs = 3 * kNanosecondsPerSecond / 2;

/// One cycle of a stage.
struct Cycle {
  std::int64_t sim_time_ns = 0;  ///< session time at its beginning
  /// The clock of source times: the host's monotonic one in real time, simulated time in lockstep.
  std::int64_t now_ns = 0;
  bool running = false;  ///< the session runs: not waiting, paused or at fault
  bool reset = false;    ///< the first cycle after a reset
  double advance = 0;    ///< simulated time this cycle may take on [s]
  /// The first one of a stage that goes on where another process' was, which ended a while ago.
  bool goes_on = false;
  /// The session ran, or stood, when the stage's process began.
  bool joined = false;
  std::int64_t computed_ns = 0;  ///< what the stage's thread computed so far; 0 in lockstep

  double time() const { return seconds_from_ns(sim_time_ns); }
  /// Of a message of this cycle.
  Header header() const { return {0, sim_time_ns, now_ns}; }
};

/// What a stage says of itself after a cycle, for its status.
struct Health {
  bool ready = true;            ///< has all it cannot do without
  const char* guard = "";       ///< which guard acts, or which input is stale; a constant text
  double real_time_factor = 0;  ///< simulated per wall time; 0: has no meaning
  double least_advance = 0;     ///< smallest useful Cycle::advance [s]; 0: takes none on
  bool finished = false;        ///< wants no further cycle
  ContactTroubles contacts;     ///< since the stage was made
  // What it has seen, as long-lived as the stage: of deformation, and of haptics.
  std::span<const OrganExtremes> organs;
  std::span<const ProbeExtremes> probes;
};

class Stage {
 public:
  virtual ~Stage() = default;
  virtual Health cycle(const Cycle& now) = 0;
  /// In lockstep, any number of times before a cycle, while something that it needs has not come:
  /// may take what the cycle would take first, which is there as far as the inputs are open.
  virtual void prepare() {}
  /// In real time, after the last cycle, at each period until it is done: what others must not be
  /// left with. @returns whether it is done
  virtual bool take_leave(const Cycle&) { return true; }
  /// After the last cycle of a lockstep session, all samples of the session being there.
  virtual void finish(const Cycle&) {}
  /// After that: goes on being shown to a person, by cycles in which time stands, until one is
  /// the last.
  virtual bool stays() const { return false; }
  /// All that its cycles depend on beside what is said on the bus; may say things that are states
  /// (bus::Delivery::kState) when it reads. One that begins anew anywhere has nothing.
  virtual void exchange(StateArchive&) {}
};

}  // namespace palpate::runtime
