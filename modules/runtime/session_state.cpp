#include "modules/runtime/session_state.h"

#include <algorithm>
#include <cstdlib>

#include "modules/core/units.h"

namespace palpate::runtime {
namespace {

/// Clocks of several hosts are known far better.
constexpr std::int64_t kClocksDiffer = kNanosecondsPerSecond;

}  // namespace

bool SessionState::believes(const SessionControl& command, std::int64_t now_ns) const {
  const Header& header = command.header;
  if (header.source_time_ns - now_ns > kClocksDiffer || header.sim_time_ns < 0) return false;
  const bool runs =
      command.command == SessionCommand::kStart || command.command == SessionCommand::kStep;
  const std::int64_t passed_ns = header.source_time_ns - command.start_time_ns;
  if (runs && std::abs(passed_ns - header.sim_time_ns) > kClocksDiffer) return false;
  const Header& before = last_.header;
  if (before.source_time_ns == 0) return true;
  const std::int64_t most_ns =
      before.sim_time_ns + std::max<std::int64_t>(0, header.source_time_ns - before.source_time_ns);
  return header.sim_time_ns - most_ns <= kClocksDiffer;
}

void SessionState::apply(const SessionControl& command) {
  if (command.header.source_time_ns < last_.header.source_time_ns) return;
  const bool first = last_.header.source_time_ns == 0;
  if (!first && command.reset_count != last_.reset_count) reset_pending_ = true;
  last_ = command;
  switch (command.command) {
    case SessionCommand::kStart:
    case SessionCommand::kStep:
      phase_ = SessionPhase::kRunning;
      break;
    case SessionCommand::kPause:
      phase_ = SessionPhase::kPaused;
      break;
    case SessionCommand::kReset:
      phase_ = SessionPhase::kWaiting;
      break;
    case SessionCommand::kStop:
      phase_ = SessionPhase::kStopped;
      break;
  }
}

bool SessionState::take_reset() {
  const bool pending = reset_pending_;
  reset_pending_ = false;
  return pending;
}

double SessionState::time(std::int64_t now_ns) const {
  switch (phase_) {
    case SessionPhase::kWaiting:
      return 0;
    case SessionPhase::kRunning: {
      const std::int64_t until_ns = halted(now_ns) ? last_.until_ns : now_ns - last_.start_time_ns;
      return std::max(0.0, seconds_from_ns(until_ns));
    }
    case SessionPhase::kPaused:
    case SessionPhase::kStopped:
      return seconds_from_ns(last_.header.sim_time_ns);
  }
  return 0;
}

bool SessionState::halted(std::int64_t now_ns) const {
  return last_.command == SessionCommand::kStep && now_ns - last_.start_time_ns >= last_.until_ns;
}

SessionControl next_command(const SessionState& state, SessionCommand wanted, std::int64_t now_ns) {
  SessionControl command = state.last_command();
  const double time = state.time(now_ns);
  command.command = wanted;
  command.header.source_time_ns = now_ns;
  command.header.sim_time_ns = ns_from_seconds(time);
  if (wanted == SessionCommand::kStart) command.start_time_ns = now_ns - ns_from_seconds(time);
  if (wanted == SessionCommand::kReset) {
    ++command.reset_count;
    command.header.sim_time_ns = 0;
  }
  return command;
}

SessionControl step_command(const SessionState& state, double duration, std::int64_t now_ns) {
  SessionControl command = next_command(state, SessionCommand::kStart, now_ns);
  command.command = SessionCommand::kStep;
  command.until_ns = command.header.sim_time_ns + ns_from_seconds(duration);
  return command;
}

}  // namespace palpate::runtime
