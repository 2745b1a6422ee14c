// The volume under contact and along a breathing curve: how exactly it is kept.
#include "deformation/organ_messages.h"
#include "deformation/steppers/symplectic_euler.h"
#include "tests/deformation/analytic/plates.h"
#include "tests/deformation/organs.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace palpate::deformation {
namespace {

testing::SqueezeErrors squeezed_to_half(int corrections) {
  auto organ = testing::ball_organ();
  organ.tissue.drag = 10;
  const auto model = testing::ball_model(3, organ);
  auto dynamics = testing::constrained(model, corrections);
  auto state = rest_state(model);
  testing::Plates plates(model, testing::kBallRadius);
  return testing::squeeze(model, dynamics, dynamics.largest_step(), 0.5, 1.0, 2.0, plates, state);
}

TEST_CASE("volume: a ball squeezed to half keeps it with one division per step") {
  // Oracle: the enclosed volume, summed over the triangles after every step. Bounds: what the
  // method is asked for, 1e-5 on the way and 1e-8 held.
  const auto errors = squeezed_to_half(0);
  CHECK(errors.peak <= 1e-5);
  CHECK(errors.held <= 1e-8);
}

TEST_CASE("volume: one Newton correction leaves 1e-9 on the way") {
  // Oracle: as above; the correction squares the relative error.
  const auto errors = squeezed_to_half(1);
  CHECK(errors.peak <= 1e-9);
  CHECK(errors.held <= 1e-9);
}

TEST_CASE("volume: corrections carry impulse, so force and pressure read the same") {
  // Oracle: the same squeeze without corrections, at rest.
  std::array<double, 2> pressure{}, force{};
  for (const int corrections : {0, 1}) {
    auto organ = testing::ball_organ();
    organ.tissue.drag = 10;
    const auto model = testing::ball_model(2, organ);
    auto dynamics = testing::constrained(model, corrections);
    auto state = rest_state(model);
    testing::Plates plates(model, testing::kBallRadius);
    testing::squeeze(model, dynamics, dynamics.largest_step(), 0.3, 0.5, 3.0, plates, state);
    pressure[corrections] = state.pressure;
    force[corrections] = plates.force();
  }
  CHECK(pressure[1] == Approx(pressure[0]).epsilon(1e-6));
  CHECK(force[1] == Approx(force[0]).epsilon(1e-6));
}

TEST_CASE("volume: the float32 positions of the wire still enclose it to 1e-8") {
  // Oracle: rounding. Coordinates below 6.4 cm are rounded by at most 2⁻²⁹ m (mean square 2⁻²⁹/√3);
  // over 642 independent nodes that is 2⁻²⁹/√3 · (area/volume)/√642 = 2.5e-9 of V; four times that.
  DeformationWorld world(testing::ball_scene(0), {geometry::make_ball(testing::kBallRadius, 3)});
  world.advance(4e-3);
  NodePositions nodes;
  deformation::write_node_positions(world, 0, nodes);
  std::vector<Vec3> received;
  for (std::size_t i = 0; i < nodes.positions.size(); i += 3) {
    received.emplace_back(nodes.positions[i], nodes.positions[i + 1], nodes.positions[i + 2]);
  }
  const double volume = geometry::enclosed_volume(received, world.model(0).triangles);
  CHECK(volume != nodes.volume);
  CHECK(std::abs(volume / nodes.volume - 1) < 1e-8);
}

TEST_CASE("volume: a breathing organ follows its curve") {
  // Oracle: V*(t) = V₀ (1 + a sin 2π f t), ± 10 % at 0.3 Hz; bound 1e-5 of V*.
  auto organ = testing::ball_organ();
  organ.filling.breathing_amplitude = 0.1;
  organ.filling.breathing_rate = 0.3;
  const auto surface = geometry::make_ball(testing::kBallRadius, 3);
  const double rest_volume = geometry::enclosed_volume(surface.nodes, surface.triangles);
  DeformationWorld world(testing::ball_scene(0, organ), {surface});
  NodePositions nodes;
  double worst = 0, largest = 0;
  for (int period = 1; period <= 1000; ++period) {
    world.advance(4e-3);
    deformation::write_node_positions(world, 0, nodes);
    const double asked = 1 + 0.1 * std::sin(2 * std::numbers::pi * 0.3 * world.time());
    REQUIRE(nodes.target_volume == Approx(rest_volume * asked).epsilon(1e-12));
    worst = std::max(worst, std::abs(nodes.volume / nodes.target_volume - 1));
    largest = std::max(largest, nodes.volume / rest_volume);
  }
  CHECK(worst <= 1e-5);
  CHECK(largest == Approx(1.1).epsilon(1e-4));
}

TEST_CASE("volume: a curve that jumps is followed as a ramp") {
  // Oracle: 50 % at the largest rate of 0.5 per second takes a second; V* stays met on the way.
  auto organ = testing::ball_organ();
  organ.filling.points = {{0, 1.5}};
  const auto surface = geometry::make_ball(testing::kBallRadius, 2);
  const double rest_volume = geometry::enclosed_volume(surface.nodes, surface.triangles);
  DeformationWorld world(testing::ball_scene(0, organ), {surface});
  NodePositions nodes;
  for (int period = 1; period <= 300; ++period) {
    REQUIRE_FALSE(world.advance(4e-3).diverged);
    deformation::write_node_positions(world, 0, nodes);
    const double ramp = std::min(1.5, 1 + 0.5 * world.time());
    CHECK(nodes.target_volume == Approx(ramp * rest_volume).epsilon(1e-9));
    CHECK(std::abs(nodes.volume / nodes.target_volume - 1) < 1e-5);
  }
}

}  // namespace
}  // namespace palpate::deformation
