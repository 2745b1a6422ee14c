// A finger presses a ball: through four topics and three processes, and back into the hand.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/system/running_session.h"

using namespace palpate;
using namespace palpate::testing;

namespace {

/// Largest distance of a node from where it was [m].
double largest_motion(const std::vector<float>& now, const std::vector<float>& then) {
  double largest = 0;
  for (std::size_t i = 0; i < std::min(now.size(), then.size()); ++i) {
    largest = std::max(largest, std::abs(double(now[i]) - double(then[i])));
  }
  return largest;
}

/// Force of a contact model at a probe position, without its friction cone.
Vec3 force_at(const ContactModel& model, const Vec3& position) {
  return model.force() + model.stiffness * (model.anchor.position - position);
}

}  // namespace

TEST_CASE("session: deformation is not ready before it has heard of contacts") {
  // Oracle: who presses as soon as all are ready must be felt. Without collision, for a second
  // after the others have heard each other, deformation is not; with it all become so.
  const BallScene scene{"topic: {start_m: [0, 0, 0.09]}"};
  RunningSession session(scene);
  session.start_module("haptics");
  session.start_module("deformation");
  REQUIRE(session.wait([](const Heard& heard) {
    return heard.modules.size() == 2 && !heard.nodes.positions.empty() &&
           heard.probe.header.sequence > 0;
  }));
  CHECK_FALSE(session.wait(
      [](const Heard& heard) {
        return heard.modules.at("deformation").state != ModuleState::kStarting;
      },
      1));
  session.start_module("collision");
  CHECK(session.wait([](const Heard& heard) {
    return heard.modules.size() == 3 && std::ranges::all_of(heard.modules, [](const auto& module) {
             return module.second.state == ModuleState::kReady;
           });
  }));
}

TEST_CASE("pressing: the tissue yields, keeps its volume, and the finger feels it") {
  // Oracle: invariants. Nothing moves before the touch; then the force points out of the tissue
  // and the nodes under the finger go at least as deep as it is in.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  REQUIRE(session.wait([](const Heard& heard) {
    return !heard.nodes.positions.empty() && heard.force.header.sequence > 100;
  }));
  const auto rest = session.heard().nodes.positions;
  CHECK(session.heard().force.force.norm() == 0);

  REQUIRE(session.press(0.05));
  const Heard& heard = session.heard();
  CHECK(heard.force.force.z() > 0.9 * heard.force.force.norm());
  REQUIRE(session.wait([&](const Heard& h) {
    return largest_motion(h.nodes.positions, rest) >
           kBallRadius + kFingerRadius - kFingerPressing - 0.002;
  }));
  CHECK(std::abs(heard.nodes.volume / heard.nodes.target_volume - 1) < 1e-4);
  CHECK(session.wait([](const Heard& h) { return h.nodes.pressure > 0; }));  // once calm

  session.move_finger(kFingerStart);  // and lets go
  CHECK(session.wait([](const Heard& h) { return h.force.force.norm() == 0; }));
  CHECK(
      session.wait([&](const Heard& h) { return largest_motion(h.nodes.positions, rest) < 1e-3; }));
}

TEST_CASE("pressing: at rest the rendered force is the tissue's, within 1 %") {
  // Oracle: action = reaction. The contact model is what deformation computed for the tissue; the
  // haptic force is what the hand gets. At rest: unchanged to 0.1 % over 100 models.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  REQUIRE(session.press(0.05));
  double difference = 1;
  Vec3 steady = Vec3::Zero();      // the model's force since…
  std::uint64_t steady_since = 0;  // …this sample
  const bool agreed = session.wait([&](const Heard& heard) {
    if ((heard.model.force() - steady).norm() > 1e-3 * steady.norm()) {
      steady = heard.model.force();
      steady_since = heard.model.header.sequence;
    }
    const bool at_rest = heard.model.header.sequence > steady_since + 100 &&
                         std::abs(heard.probe.pose.position.z() - kFingerPressing) < 1e-5;
    const Vec3 reaction = force_at(heard.model, heard.probe.pose.position);
    difference = (heard.force.force - reaction).norm() / reaction.norm();
    return at_rest && heard.model.touching() && difference < 0.01;
  });
  INFO("difference " << difference << ", haptic " << session.heard().force.force.transpose()
                     << ", model " << session.heard().model.force().transpose() << ", kinetic "
                     << session.heard().nodes.kinetic_energy << ", limits "
                     << session.heard().force.limits << ", nodes of "
                     << 1e-9 * double(session.heard().nodes.header.sim_time_ns) << " s, model of "
                     << 1e-9 * double(session.heard().model.header.sim_time_ns) << " s, "
                     << session.heard().contacts.contacts.size() << " contacts, deformation: "
                     << session.heard().modules.at("deformation").last_error);
  CHECK(agreed);
}

TEST_CASE("pressing: pause holds everything, reset brings the ball back to rest at time zero") {
  // Oracle: definition.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  REQUIRE(session.press(0.05));
  session.command(SessionCommand::kPause);
  REQUIRE(session.wait([](const Heard& heard) {
    return heard.modules.at("deformation").state == ModuleState::kPaused;
  }));
  const auto held = session.heard().nodes;
  REQUIRE(session.wait(
      [&](const Heard& heard) { return heard.nodes.header.sequence > held.header.sequence + 50; }));
  CHECK(session.heard().nodes.header.sim_time_ns == held.header.sim_time_ns);
  CHECK(session.heard().nodes.positions == held.positions);

  session.move_finger(kFingerStart);
  session.command(SessionCommand::kReset);
  REQUIRE(session.wait([&](const Heard& heard) {
    return heard.nodes.generation > held.generation && heard.nodes.header.sim_time_ns == 0;
  }));
  session.command(SessionCommand::kStart);
  CHECK(session.wait([](const Heard& heard) { return heard.nodes.header.sim_time_ns > 0; }));
  CHECK(session.heard().nodes.header.sim_time_ns < held.header.sim_time_ns + 1'000'000'000);
}
