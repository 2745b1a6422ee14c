#include "palpate/session/in_process.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "haptics/devices/placed_device.h"
#include "modules/geometry/primitives.h"
#include "modules/geometry/winding_number.h"
#include "modules/scene/scene_reader.h"
#include "palpate/session/timed_stage.h"

namespace palpate::session {
namespace {

constexpr double kRadius = 0.05;
constexpr double kTip = 0.008;

/// A ball held at its lower third, pressed from above by a spherical tip along a script.
scene::Scene press_scene(std::vector<scene::ScriptedDevice::Move> moves, double friction = 0.1) {
  scene::Scene scene;
  scene::Organ organ;
  organ.name = "ball";
  organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.03)});
  organ.tissue.drag = 10;
  organ.springs.inner_ratio = 0.6;  // so that a tip meets a force worth comparing
  scene.organs.push_back(organ);
  scene::ScriptedDevice device;
  device.start = Vec3(0, 0, kRadius + kTip + 0.005);
  device.moves = std::move(moves);
  scene.probes.push_back({"tip", scene::SphereShape{kTip}, friction, device});
  return scene;
}

InProcess ball_session(const scene::Scene& scene, int levels = 3) {
  return InProcess(scene, {{geometry::make_ball(kRadius, levels)}, {geometry::TriangleSurface{}}});
}

Vec3 at_depth(double depth) { return Vec3(0, 0, kRadius + kTip - depth); }

TEST_CASE("session in process: a pressed ball pushes back along the normal and keeps its volume") {
  // Oracle: invariants; nothing touches before, everything is pushed up after.
  auto session = ball_session(press_scene({{at_depth(0.015), 1.0}, {std::nullopt, 1.0}}));
  session.run_until(0.05);
  CHECK(session.haptic_force(0).force.norm() == 0);
  double worst = 0;
  while (session.time() < 2.0) {
    session.tick();
    const auto& nodes = session.node_positions(0);
    worst = std::max(worst, std::abs(nodes.volume / nodes.target_volume - 1));
  }
  CHECK(worst < 1e-4);
  const Vec3 force = session.haptic_force(0).force;
  CHECK(force.z() > 0.05);
  CHECK(force.head<2>().norm() < 0.05 * force.z());
  CHECK(session.node_positions(0).pressure > 1);
}

TEST_CASE("session in process: at rest the hand feels what the tissue gets, within 1 %") {
  // Oracle: action = reaction.
  auto session = ball_session(press_scene({{at_depth(0.012), 1.0}, {std::nullopt, 1.0}}));
  session.run_until(2.0);
  const Vec3 tissue = session.contact_model(0).force(), hand = session.haptic_force(0).force;
  REQUIRE(tissue.norm() > 0.02);
  CHECK((hand - tissue).norm() < 0.01 * tissue.norm());
  CHECK(session.haptic_force(0).limits == kForceNotLimited);
}

TEST_CASE(
    "session in process: friction drags a sliding tip back, and no more than its coefficient "
    "allows") {
  // Oracle: Coulomb's law. 5 %: the normals of several contacts differ a little.
  const double mu = 0.2;
  auto session = ball_session(
      press_scene({{at_depth(0.010), 1.0}, {at_depth(0.010) + Vec3(0.015, 0, 0), 1.0}}, mu));
  session.run_until(1.6);
  const auto& model = session.contact_model(0);
  REQUIRE(model.touching());
  CHECK(model.force().x() < 0);
  for (const LawRow& row : model.rows) {
    const double normal = row.force.dot(row.normal);
    CHECK((row.force - normal * row.normal).norm() <= mu * normal * 1.05);
  }
}

TEST_CASE("session in process: the same scene gives the same bits") {
  // Oracle: itself, run twice.
  const auto scene =
      press_scene({{at_depth(0.012), 0.3}, {at_depth(0.010) + Vec3(0.02, 0, 0), 0.3}});
  auto first = ball_session(scene, 2), second = ball_session(scene, 2);
  for (int tick = 0; tick < 600; ++tick) {
    first.tick();
    second.tick();
    REQUIRE(first.haptic_force(0).force == second.haptic_force(0).force);
  }
  CHECK(first.node_positions(0).positions == second.node_positions(0).positions);
  CHECK(first.node_positions(0).pressure == second.node_positions(0).pressure);
}

TEST_CASE("session in process: an emulated device yields to the force that it feels") {
  // Oracle: balance of forces at rest, k (x_t − x) + f = 0, within 1 % of the force; and the same
  // bits again. The encoders' step of 55 µm moves a hand of 50 N/m by 3 mN: exact ones.
  auto scene = press_scene({});
  scene::EmulatedDevice device;
  device.start = Vec3(0, 0, kRadius + kTip + 0.005);
  device.encoder_step = 0;
  device.hand.damping = 3;
  device.hand.stiffness = 50;
  device.hand.moves = {{at_depth(0.015), 1.0}};
  scene.probes[0].device = device;
  std::vector<double> ends;
  for (int run = 0; run < 2; ++run) {
    auto session = ball_session(scene);
    session.run_until(4);
    const Vec3 lacking = at_depth(0.015) - session.probe(0).pose.position;
    const Vec3 force = session.haptic_force(0).force;
    CHECK(force.z() > 0.05);
    CHECK((50 * lacking + force).norm() < 0.01 * force.norm());
    ends.push_back(session.probe(0).pose.position.z());
    ends.push_back(force.z());
  }
  CHECK(ends[0] == ends[2]);
  CHECK(ends[1] == ends[3]);
}

TEST_CASE("session in process: a tip at 500 mm/s does not pass through, at any collision rate") {
  // Oracle: winding number; the tip's centre never enters the organ.
  auto scene = press_scene({{at_depth(0.035), 0.08}, {std::nullopt, 0.2}});  // 1.875·40 mm/80 ms
  scene.rates.collision = GENERATE(50.0, 100.0, 250.0, 1000.0);
  auto session = ball_session(scene);
  const auto triangles = geometry::make_ball(kRadius, 3).triangles;
  double fastest = 0, force = 0;
  for (int tick = 0; tick < 280; ++tick) {
    session.tick();
    fastest = std::max(fastest, session.probe(0).twist.linear.norm());
    force = std::max(force, session.contact_model(0).force().z());
    if (tick % 10 != 0) continue;
    INFO("collision at " << scene.rates.collision << " Hz, t = " << session.time() << " s");
    CHECK(geometry::winding_number(session.probe(0).pose.position,
                                   session.node_positions(0).positions, triangles) < 0.5);
  }
  CHECK(fastest > 0.5);
  CHECK(force > 0.1);
}

TEST_CASE("session in process: a sliding tip feels a steady force, however late contacts are") {
  // Oracle: the same slide with contacts of every step. A slow collision leaves contacts up to four
  // deformation steps old; what is felt may then differ by what a contact found late would add. The
  // largest step is that of first touch: the three nodes of a triangle take on the tip's speed v
  // (1.875 of the mean) within one step, 3 m v/T.
  const auto slide = [](double collision_hz, double& largest_step) {
    auto scene = press_scene({{at_depth(0.012), 1.0}, {at_depth(0.012) + Vec3(0.03, 0, 0), 2.0}});
    scene.rates.collision = collision_hz;
    auto session = ball_session(scene);
    std::vector<double> forces;
    while (session.time() < 2.9) {
      session.run_until(session.time() + 0.004);
      forces.push_back(session.contact_model(0).force().norm());
      if (forces.size() < 2) continue;
      largest_step = std::max(largest_step, std::abs(forces.back() - forces[forces.size() - 2]));
    }
    return forces;
  };
  double step_at_250 = 0, step_at_60 = 0;
  const auto prompt = slide(250, step_at_250), late = slide(62.5, step_at_60);
  const double largest = *std::max_element(prompt.begin(), prompt.end());
  REQUIRE(largest > 0.05);
  const double node_mass = 1058 * 4 / 3.0 * M_PI * std::pow(kRadius, 3) / 648;
  const double first_touch = 3 * node_mass * 1.875 * 0.017 / 0.004;
  CHECK(step_at_250 < first_touch);
  CHECK(step_at_60 < first_touch);
  for (std::size_t i = 0; i < prompt.size(); ++i) {
    CHECK(std::abs(prompt[i] - late[i]) < 0.05 * largest);
  }
}

TEST_CASE(
    "session in process: an insufflated stomach follows its curve and swells against the finger") {
  // Oracle: the scene's own curve, met to 1e-5; the force on a resting finger grows with filling.
  auto session =
      load_session(scene::load_scene(PALPATE_SOURCE_DIR "/scenes/stomach_insufflated.yaml"));
  double worst = 0, empty_force = 0, full_force = 0, fullest = 0;
  const double rest_volume = session.node_positions(0).target_volume;
  while (session.time() < 10) {
    session.run_until(session.time() + 0.1);
    const NodePositions& nodes = session.node_positions(0);
    worst = std::max(worst, std::abs(nodes.volume / nodes.target_volume - 1));
    fullest = std::max(fullest, nodes.volume / rest_volume);
    const double force = session.haptic_force(0).force.norm();
    if (session.time() > 2 && session.time() < 3) empty_force = std::max(empty_force, force);
    if (session.time() > 8) full_force = std::max(full_force, force);
  }
  CHECK(worst <= 1e-5);
  CHECK(fullest == Approx(1.27).epsilon(0.005));  // 1.25 and 2 % of breathing
  CHECK(full_force > 3 * empty_force);
}

TEST_CASE("session in process: every module runs at its own rate") {
  // Oracle: the k-th cycle begins at k/rate.
  auto scene = press_scene({{std::nullopt, 1.0}});
  scene.rates.collision = 200;
  scene.rates.deformation = 100;
  auto session = ball_session(scene, 1);
  for (int tick = 0; tick < 100; ++tick) {
    session.tick();
    CHECK(session.probe(0).header.sim_time_ns == tick * 1'000'000);
    CHECK(session.contacts(0).header.sim_time_ns == tick / 5 * 5'000'000);
    // what a period leads to
    CHECK(session.node_positions(0).header.sim_time_ns == (tick / 10 + 1) * 10'000'000);
  }
}

TEST_CASE("session in process: an elastic energy that is told was true within the last 0.04 s") {
  // Oracle: the world's own energies after the last four advances of 0.01 s, of a ball that is
  // pressed: all of them differ, and each fourth is told.
  auto scene = press_scene({{at_depth(0.012), 1.0}});
  scene.rates.deformation = 100;
  auto session = ball_session(scene);
  session.run_until(0.5);
  std::vector<double> own;
  std::set<double> told;
  for (int advance = 0; advance < 40; ++advance) {
    session.run_until(session.time() + 0.01);
    own.push_back(session.world().elastic_energy(0));
    if (own.size() < 4) continue;
    const double energy = session.node_positions(0).elastic_energy;
    CHECK(std::find(own.end() - 4, own.end(), energy) != own.end());
    told.insert(energy);
  }
  CHECK(told.size() >= 9);
  CHECK(told.size() <= 10);
}

TEST_CASE("session in process: a module is timed, replaced or left out, and the rest is as usual") {
  // Oracle: a clock that counts its readings, 1 s each; who searches no contacts feels nothing.
  static double readings = 0;
  const auto clock = [] { return ++readings; };
  double seconds = 0;
  const auto scene = press_scene({{at_depth(0.012), 0.2}});
  InProcessOptions timed, blind;
  timed.make = [&](std::string_view module, bus::Bus& bus,
                   const MakeStage& usual) -> std::unique_ptr<runtime::Stage> {
    if (module != "deformation") return usual(bus);
    return std::make_unique<TimedStage>(usual(bus), clock, seconds);
  };
  blind.make = [](std::string_view module, bus::Bus& bus, const MakeStage& usual) {
    return module == "collision" ? nullptr : usual(bus);
  };
  const auto assets = [] {
    return Assets{{geometry::make_ball(kRadius, 2)}, {geometry::TriangleSurface{}}};
  };
  InProcess usual(scene, assets()), watched(scene, assets(), timed), unseen(scene, assets(), blind);
  for (InProcess* session : {&usual, &watched, &unseen}) session->run_until(0.2);
  CHECK(seconds == 50);  // periods of 4 ms
  REQUIRE(usual.haptic_force(0).force.norm() > 0.01);
  CHECK(watched.haptic_force(0).force == usual.haptic_force(0).force);
  CHECK(unseen.contacts(0).header.sequence == 0);
  CHECK(unseen.haptic_force(0).force.norm() == 0);
}

TEST_CASE("session in process: a placed probe is where it was put last") {
  // Oracle: the poses given.
  const auto scene = press_scene({{std::nullopt, 1.0}});
  auto session = ball_session(scene, 1);
  auto device = std::make_unique<haptics::PlacedDevice>(Pose{});
  haptics::PlacedDevice& placed = *device;
  session.haptics().set_device(0, std::move(device));
  Pose pose;
  pose.position = Vec3(0.1, 0, 0);
  placed.place(pose, {Vec3(0, 0.5, 0), Vec3::Zero()});
  session.tick();
  CHECK(session.probe(0).pose.position == pose.position);
  CHECK(session.probe(0).twist.linear == Vec3(0, 0.5, 0));
  pose.position.x() = 0.2;
  placed.place(pose);
  session.tick();
  CHECK(session.probe(0).pose.position == pose.position);
  CHECK(session.probe(0).twist.linear == Vec3::Zero());
}

}  // namespace
}  // namespace palpate::session
