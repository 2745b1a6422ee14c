// What the commands of a session mean: pure rules, no bus, no clock.
#pragma once

#include <cstdint>

#include "modules/messages/messages.h"

namespace palpate::runtime {

enum class SessionPhase {
  kWaiting,  ///< not started, or reset and not started again
  kRunning,
  kPaused,
  kStopped
};

/// Follows the commands of a session. Several may give commands (the launcher; a person at the
/// visualizer); the one with the newest source time holds, older ones are ignored.
class SessionState {
 public:
  void apply(const SessionControl& command);

  /// In real time: whether a command can have been given in this session by `now_ns`. One of the
  /// future would hold for ever. The simulated time it tells is no further on than the clock is
  /// since the last command; if the session runs from it, it began that long before.
  bool believes(const SessionControl& command, std::int64_t now_ns) const;

  SessionPhase phase() const { return phase_; }
  /// True once after each reset that came after the first command heard: a module that joins late
  /// starts from rest anyway.
  bool take_reset();
  /// Session time [s]: 0 while waiting, standing still while paused, at the end of a step and after
  /// the end.
  double time(std::int64_t now_ns) const;
  /// In real time: a step (kStep) that has come to its end stands as a pause does.
  bool halted(std::int64_t now_ns) const;
  /// Of a lockstep session: cycles before this simulated time may begin; 0 before the first grant.
  std::int64_t granted_until_ns() const { return last_.until_ns; }
  const SessionControl& last_command() const { return last_; }  ///< source time 0 before the first

 private:
  SessionPhase phase_ = SessionPhase::kWaiting;
  SessionControl last_;
  bool reset_pending_ = false;
};

/// The command that leads from the present state to the one wanted, given at `now_ns`. Resuming is
/// kStart with a start time moved by the pause; kReset counts up and leaves the session waiting.
SessionControl next_command(const SessionState& state, SessionCommand wanted, std::int64_t now_ns);

/// In real time: goes on for `duration` [s] of simulated time, then stands.
SessionControl step_command(const SessionState& state, double duration, std::int64_t now_ns);

}  // namespace palpate::runtime
