// A process dies or hangs while a finger presses: the hand is let go, and a new one joins.
#include <catch2/catch.hpp>

#include "tests/system/running_session.h"

using namespace palpate;
using namespace palpate::testing;

namespace {

/// Slack of a deadline for transport, two loops' periods and a busy machine [s].
constexpr double kSlack = 0.15;

bool force_is_zero(const Heard& heard) { return heard.force.force.norm() == 0; }

double seconds_between(std::int64_t begin_ns, std::int64_t end_ns) {
  return 1e-9 * static_cast<double>(end_ns - begin_ns);
}

}  // namespace

TEST_CASE("dead deformation: the force fades within stale_after + fade_time") {
  // Oracle: the scene's promise, measured on the source times of the last model and of the first
  // zero force.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  REQUIRE(session.press(0.05));
  session.kill("deformation");
  REQUIRE(session.wait(force_is_zero));
  const double took = seconds_between(session.heard().model.header.source_time_ns,
                                      session.heard().force.header.source_time_ns);
  const auto& limits = session.scene().haptics;
  CHECK(took <= limits.stale_after + limits.fade_time + kSlack);
  CHECK(took >= limits.stale_after);  // it did not drop it at once
  CHECK((session.heard().force.limits & kForceStaleFade) != 0);
  CHECK(session.wait([](const Heard& heard) {
    const ModuleStatus& haptics = heard.modules.at("haptics");
    return haptics.state == ModuleState::kDegraded &&
           haptics.last_error.find("contact model") != std::string::npos;
  }));
}

TEST_CASE("dead deformation: started again it joins, and is pressed where the finger is") {
  // Oracle: force and state after the new start.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  REQUIRE(session.press(0.05));
  session.kill("deformation");
  REQUIRE(session.wait(force_is_zero));
  session.move_finger(kFingerStart);
  REQUIRE(session.wait(
      [](const Heard& heard) { return heard.probe.pose.position.z() > kFingerStart - 1e-3; }));
  const auto killed_at = session.heard().nodes.header;
  session.start_module("deformation");
  REQUIRE(session.wait([&](const Heard& heard) {
    return heard.nodes.header.source_time_ns > killed_at.source_time_ns;
  }));
  CHECK(session.press(0.05));
  CHECK(session.heard().nodes.header.sim_time_ns > killed_at.sim_time_ns);  // session time, not 0
  CHECK(session.heard().modules.at("deformation").state >= ModuleState::kRunning);
}

TEST_CASE("dead collision: contacts are dropped, the force ends, and started again it joins") {
  // Oracle: kInputStaleAfter, then the model has no rows, and says so.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  REQUIRE(session.press(0.05));
  session.kill("collision");
  const std::int64_t killed_ns = runtime::monotonic_now_ns();
  REQUIRE(session.wait(
      [](const Heard& heard) { return force_is_zero(heard) && !heard.model.touching(); }));
  CHECK(seconds_between(killed_ns, session.heard().force.header.source_time_ns) <
        0.05 + 0.1 + kSlack);
  CHECK(session.wait([](const Heard& heard) {
    return heard.modules.at("deformation").last_error.find("stale") != std::string::npos;
  }));
  session.start_module("collision");
  CHECK(session.wait([](const Heard& heard) { return heard.force.force.norm() > 0.05; }));
}

TEST_CASE("dead haptics: the tissue is not pushed by a finger that nobody moves") {
  // Oracle: the ball returns to where it was.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  REQUIRE(session.press(0.05));
  session.kill("haptics");
  REQUIRE(session.wait([](const Heard& heard) {
    return !heard.model.touching() && heard.contacts.contacts.empty();
  }));
  CHECK(session.wait([](const Heard& heard) { return heard.nodes.kinetic_energy < 1e-8; }));
  session.start_module("haptics");  // begins at its start, is driven back, presses again
  CHECK(session.wait([&](const Heard& heard) {
    return heard.force.header.source_time_ns > runtime::monotonic_now_ns() - 100'000'000 &&
           heard.force.force.norm() > 0.05;
  }));
}

TEST_CASE("hanging collision: what it says after it wakes is used only when it is fresh") {
  // Oracle: the force is zero while it hangs, and back after.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  REQUIRE(session.press(0.05));
  session.child("collision").signal(SIGSTOP);
  REQUIRE(session.wait(force_is_zero));
  session.child("collision").signal(SIGCONT);
  CHECK(session.wait([](const Heard& heard) { return heard.force.force.norm() > 0.05; }));
}
