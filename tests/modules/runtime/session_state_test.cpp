#include "modules/runtime/session_state.h"
#include "tests/times.h"

#include <catch2/catch.hpp>

using namespace palpate;
using namespace palpate::runtime;

namespace {

/// Gives a command at a time and applies it.
SessionControl give(SessionState& state, SessionCommand command, double seconds) {
  const auto message = next_command(state, command, static_cast<std::int64_t>(seconds * 1e9));
  state.apply(message);
  return message;
}

double time(const SessionState& state, double seconds) {
  return state.time(static_cast<std::int64_t>(seconds * 1e9));
}

}  // namespace

TEST_CASE("session state: time runs from start, stands in a pause and goes on where it stood") {
  // Oracle: a stop watch, by hand.
  SessionState state;
  CHECK(state.phase() == SessionPhase::kWaiting);
  CHECK(time(state, 99) == 0);
  give(state, SessionCommand::kStart, 100);
  CHECK(state.phase() == SessionPhase::kRunning);
  CHECK(time(state, 102.5) == Approx(2.5));
  give(state, SessionCommand::kPause, 103);
  CHECK(state.phase() == SessionPhase::kPaused);
  CHECK(time(state, 150) == Approx(3));
  give(state, SessionCommand::kStart, 200);
  CHECK(time(state, 201) == Approx(4));
  give(state, SessionCommand::kStop, 202);
  CHECK(state.phase() == SessionPhase::kStopped);
  CHECK(time(state, 300) == Approx(5));
}

TEST_CASE("session state: a step in real time goes on for as long as it says, and stands") {
  // Oracle: a stop watch, by hand.
  SessionState state;
  const auto step = [&](double duration, double seconds) {
    state.apply(step_command(state, duration, static_cast<std::int64_t>(seconds * 1e9)));
  };
  const auto halted = [&](double seconds) {
    return state.halted(static_cast<std::int64_t>(seconds * 1e9));
  };
  give(state, SessionCommand::kStart, 100);
  give(state, SessionCommand::kPause, 103);
  CHECK_FALSE(halted(104));
  step(0.5, 110);
  CHECK(time(state, 110.25) == Approx(3.25));
  CHECK_FALSE(halted(110.25));
  CHECK(time(state, 120) == Approx(3.5));
  CHECK(halted(120));
  step(0.5, 130);  // a second one, from where the first ended
  CHECK(time(state, 131) == Approx(4));
  step(10, 140);
  step(10, 141);  // one upon another
  CHECK(time(state, 200) == Approx(15));
  give(state, SessionCommand::kStart, 210);
  CHECK(time(state, 211) == Approx(16));
  CHECK_FALSE(halted(211));
}

TEST_CASE("session state: a command that cannot have been given is not believed") {
  // Oracle: definition. Whoever had the token ended a session by a start in the distant past, as
  // simulated for a hundred years, and locked it by a command of the future.
  const auto at = [](double seconds) { return static_cast<std::int64_t>(seconds * 1e9); };
  SessionState state;
  const SessionControl start = next_command(state, SessionCommand::kStart, at(100));
  CHECK(state.believes(start, at(100)));
  CHECK(state.believes(start, at(99.5)));  // clocks of two hosts
  CHECK_FALSE(state.believes(start, at(98)));
  state.apply(start);
  CHECK(state.believes(start, at(150)));  // said again
  const SessionControl pause = next_command(state, SessionCommand::kPause, at(110));
  CHECK(state.believes(pause, at(110)));
  SessionControl later = pause;  // of a session that ran for an hour
  later.header.sim_time_ns = at(3600);
  CHECK_FALSE(state.believes(later, at(110)));
  later.header.sim_time_ns = -1;
  CHECK_FALSE(state.believes(later, at(110)));
  state.apply(pause);
  const SessionControl on = next_command(state, SessionCommand::kStart, at(200));
  CHECK(state.believes(on, at(200)));
  SessionControl absurd = on;
  absurd.start_time_ns = -(std::int64_t{1} << 62);
  CHECK_FALSE(state.believes(absurd, at(200)));
  absurd.header.sim_time_ns = absurd.header.source_time_ns - absurd.start_time_ns;
  CHECK_FALSE(state.believes(absurd, at(200)));
  CHECK(state.believes(step_command(state, 5, at(200)), at(200)));
  CHECK(state.believes(next_command(state, SessionCommand::kReset, at(200)), at(200)));
  // Two of the commands between were never heard, and another launcher begins anew.
  SessionState another;
  another.apply(next_command(another, SessionCommand::kStart, at(110)));
  CHECK(state.believes(next_command(another, SessionCommand::kPause, at(190)), at(190)));
  CHECK(state.believes(next_command(SessionState{}, SessionCommand::kStart, at(210)), at(210)));
}

TEST_CASE("session state: a reset is told once, sets time to zero and waits for start") {
  // Oracle: definition.
  SessionState state;
  give(state, SessionCommand::kStart, 100);
  CHECK_FALSE(state.take_reset());
  give(state, SessionCommand::kReset, 110);
  CHECK(state.phase() == SessionPhase::kWaiting);
  CHECK(time(state, 111) == 0);
  CHECK(state.take_reset());
  CHECK_FALSE(state.take_reset());
  give(state, SessionCommand::kStart, 112);
  CHECK(time(state, 113) == Approx(1));
  CHECK_FALSE(state.take_reset());
}

TEST_CASE("session state: a reset whose command was replaced by the start after it is not lost") {
  // Oracle: readers keep only the newest sample, so a module may see the start alone.
  SessionState giver, module;
  module.apply(give(giver, SessionCommand::kStart, 100));
  give(giver, SessionCommand::kReset, 110);
  module.apply(give(giver, SessionCommand::kStart, 110.001));
  CHECK(module.take_reset());
  CHECK(module.phase() == SessionPhase::kRunning);
  CHECK(time(module, 111.001) == Approx(1));
}

TEST_CASE("session state: a module that joins late takes the session's time and needs no reset") {
  // Oracle: definition.
  SessionState giver, late;
  give(giver, SessionCommand::kStart, 100);
  give(giver, SessionCommand::kReset, 105);
  late.apply(give(giver, SessionCommand::kStart, 106));
  CHECK_FALSE(late.take_reset());
  CHECK(time(late, 108) == Approx(2));
}

TEST_CASE("session state: of several givers the newest command holds, repeats change nothing") {
  // Oracle: the order of source times.
  SessionState launcher, person;
  const auto start = give(launcher, SessionCommand::kStart, 100);
  person.apply(start);
  const auto pause = give(person, SessionCommand::kPause, 104);
  SessionState module;
  module.apply(pause);
  module.apply(start);  // the launcher repeats itself, not yet knowing
  CHECK(module.phase() == SessionPhase::kPaused);
  CHECK(time(module, 110) == Approx(4));
  module.apply(pause);
  CHECK(time(module, 120) == Approx(4));
}

TEST_CASE("session state: a start that lies ahead gives no negative time") {
  // Oracle: definition.
  SessionState state;
  SessionControl start;
  start.header.source_time_ns = kSecond;
  start.start_time_ns = 5 * kSecond;
  state.apply(start);
  CHECK(state.time(4 * kSecond) == 0);
  CHECK(state.time(6 * kSecond) == Approx(1));
}
