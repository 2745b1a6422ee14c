// Whoever falls silent while a finger presses, the hand is let go: in time, and within the slew
// limit. Real processes over loopback; the finger has a real device's type, `topic`.
#include <catch2/catch.hpp>

#include "tests/system/running_session.h"

using namespace palpate;
using namespace palpate::testing;

namespace {

constexpr double kPressed = 0.05;  // [N]; at rest it is 0.069
/// stale_after_s + fade_time_s, and 10 ms for the last sample's way and a late tick. What may come
/// later is not what was sent but what this test heard, so it counts the last force that was not
/// zero.
constexpr double kReleased = 0.110;  // [s]

struct Pressed {
  BallScene scene{"topic: {start_m: [0, 0, 0.09]}"};
  RunningSession session{scene};

  Pressed() {
    session.move_finger(kFingerStart);
    REQUIRE(session.start());
    REQUIRE(session.press(kPressed));
    // The tissue swings for a moment where the finger has come to rest.
    const std::int64_t calm_ns = session.heard().nodes.header.sim_time_ns + 1'000'000'000;
    const bool calm = session.wait([&](const Heard& heard) {
      return heard.nodes.header.sim_time_ns > calm_ns && heard.force.force.norm() > kPressed;
    });
    INFO("force " << session.heard().force.force.transpose() << " limits "
                  << session.heard().force.limits << " at "
                  << session.heard().probe.pose.position.transpose() << ", model "
                  << session.heard().model.force().transpose());
    REQUIRE(calm);
  }

  /// The force goes to zero after `since_ns` as promised. @returns when the last was sent [s]
  double wait_for_release(std::int64_t since_ns) {
    REQUIRE(session.wait([](const Heard& heard) { return heard.force.force.norm() == 0; }));
    const double took = 1e-9 * double(session.heard().last_pushed_ns - since_ns);
    UNSCOPED_INFO("let go after " << took << " s, largest step per tick "
                                  << session.heard().largest_force_step << " N");
    return took;
  }
  /// Change allowed per tick [N], with what rounding does to it.
  double largest_step() const {
    const auto& scene_in = session.scene();
    return scene_in.haptics.max_force_rate / scene_in.rates.haptics * (1 + 1e-9);
  }
};

}  // namespace

TEST_CASE("released: a driver that falls silent is let go, named, and taken back with a ramp") {
  // Oracle: the scene's promise, on the source times of the driver's last word and of the forces.
  Pressed pressed;
  RunningSession& session = pressed.session;
  session.silence_driver(kFingerPressing);
  const std::int64_t silent_ns = session.heard().last_driven_ns;
  const double took = pressed.wait_for_release(silent_ns);
  CHECK(took <= kReleased);
  CHECK(took >= session.scene().haptics.stale_after);
  CHECK((session.heard().force.limits & kDriverSilent) != 0);
  CHECK(session.wait([](const Heard& heard) {
    const ModuleStatus& haptics = heard.modules.at("haptics");
    return haptics.state == ModuleState::kDegraded &&
           haptics.last_error.find("probe 'finger': its driver is silent") == 0;
  }));
  CHECK(session.press(kPressed));
  CHECK(session.heard().largest_force_step <= pressed.largest_step());
}

TEST_CASE("released: while the session is paused nothing pushes, and it goes on within the limit") {
  // Oracle: the same promise, from the last law that was given.
  Pressed pressed;
  RunningSession& session = pressed.session;
  session.command(SessionCommand::kPause);
  REQUIRE(session.wait([](const Heard& heard) {
    return heard.modules.at("deformation").state == ModuleState::kPaused;
  }));
  CHECK(pressed.wait_for_release(session.heard().model.header.source_time_ns) <= kReleased);
  session.command(SessionCommand::kStart);
  CHECK(session.wait([](const Heard& heard) { return heard.force.force.norm() > kPressed; }));
  CHECK(session.heard().largest_force_step <= pressed.largest_step());
}

TEST_CASE("released: a session at fault, told of another scene while it presses, lets go") {
  // Oracle: the same promise, from the last law that was given.
  Pressed pressed;
  RunningSession& session = pressed.session;
  const BallScene other{"topic: {start_m: [0, 0, 0.2]}"};
  bus::DdsBus bus(session.options());
  auto scenes = bus.writer(bus::kScene);
  SceneDescription description = runtime::scene_description(scene::load_scene(other.file()));
  REQUIRE(scenes.write(description));
  REQUIRE(session.wait([](const Heard& heard) {
    return heard.modules.at("deformation").state == ModuleState::kFault;
  }));
  CHECK(pressed.wait_for_release(session.heard().model.header.source_time_ns) <= kReleased);
  CHECK(session.heard().largest_force_step <= pressed.largest_step());
}

TEST_CASE("released: a module that is killed lets go") {
  // Oracle: the same promise. Deformation: from its last law. Collision: its contacts hold for
  // 50 ms, and one cycle of deformation later the tissue has let go; from its last contacts.
  const std::string module = GENERATE("deformation", "collision");
  Pressed pressed;
  RunningSession& session = pressed.session;
  session.kill(module);
  pressed.wait_for_release(0);
  const std::int64_t last_ns = module == "collision"
                                   ? session.heard().contacts.header.source_time_ns
                                   : session.heard().model.header.source_time_ns;
  const double took = 1e-9 * double(session.heard().last_pushed_ns - last_ns);
  INFO(module << " killed, let go after " << took << " s");
  CHECK(took <= kReleased);
  CHECK(session.heard().largest_force_step <= pressed.largest_step());
}

TEST_CASE("released: a reset lets go within the slew limit") {
  // Oracle: the slew limit.
  Pressed pressed;
  RunningSession& session = pressed.session;
  session.command(SessionCommand::kReset);
  REQUIRE(session.wait([](const Heard& heard) { return heard.force.force.norm() == 0; }));
  CHECK(session.heard().largest_force_step <= pressed.largest_step());
}
