// A ball between two plates: volume, and action = reaction.
#include "deformation/organ_messages.h"
#include "deformation/world.h"
#include "tests/deformation/organs.h"

#include <catch2/catch.hpp>

namespace palpate::deformation {
namespace {

using testing::ball_organ;
using testing::ball_scene;
using testing::kBallRadius;
using testing::kPeriod;
using testing::plate_contacts;

DeformationWorld ball_world(int levels, const scene::Organ& organ) {
  return DeformationWorld(ball_scene(2, organ), {geometry::make_ball(kBallRadius, levels)});
}

/// Two plates close to `compression` of the diameter in `seconds`, then hold for `hold` seconds.
struct Squeeze {
  double worst_volume_error = 0, held_volume_error = 0, pressure = 0;
  double upper_force = 0, lower_force = 0;
  double kinetic_energy = 0;
};

Squeeze squeeze(DeformationWorld& world, double compression, double seconds, double hold) {
  Squeeze result;
  NodePositions nodes;
  const int moving = static_cast<int>(seconds / kPeriod),
            holding = static_cast<int>(hold / kPeriod);
  double height = kBallRadius;
  for (int cycle = 1; cycle <= moving + holding; ++cycle) {
    height = kBallRadius * (1 - compression * std::min(1.0, cycle / double(moving)));
    for (std::uint32_t probe = 0; probe < 2; ++probe) {
      const int side = probe == 0 ? 1 : -1;
      world.set_contacts(plate_contacts(world, probe, side * height, side, 2e-3));
      world.set_probe(probe, Pose{Vec3(0, 0, side * height), Quat::Identity()});
    }
    world.advance(kPeriod);
    deformation::write_node_positions(world, 0, nodes);
    result.held_volume_error = std::abs(nodes.volume / nodes.target_volume - 1);
    result.worst_volume_error = std::max(result.worst_volume_error, result.held_volume_error);
  }
  ContactModel upper, lower;
  upper = deformation::contact_model_message(world, 0);
  lower = deformation::contact_model_message(world, 1);
  result.pressure = nodes.pressure;
  result.upper_force = upper.force().z();
  result.lower_force = lower.force().z();
  result.kinetic_energy = nodes.kinetic_energy;
  return result;
}

TEST_CASE("squeezed ball: by 30 % it keeps its volume and pushes both plates") {
  // Oracle: the volume error table of the method with contact inside the solve (3.9e-5 peak,
  // 2.2e-9 held at h = 1 ms), action = reaction of two plates at rest. Held here to 1e-7: the
  // node positions leave as float32 only after the volume is taken.
  auto organ = ball_organ();
  organ.tissue.drag = 10;
  auto world = ball_world(3, organ);
  const auto result = squeeze(world, 0.3, 1.0, 1.5);
  CHECK(result.worst_volume_error < 1e-4);
  CHECK(result.held_volume_error < 1e-7);
  CHECK(result.upper_force > 0.1);
  CHECK(result.lower_force == Approx(-result.upper_force).epsilon(0.01));
  CHECK(result.pressure > 10);
}

TEST_CASE("squeezed ball: plain mass-spring loses the volume the constraint keeps") {
  // Oracle: the same table, plain mass-spring: tens of per cent.
  auto organ = ball_organ();
  organ.model = "mass_spring";
  auto world = ball_world(2, organ);
  CHECK(squeeze(world, 0.3, 0.5, 0.5).held_volume_error > 0.05);
}

}  // namespace
}  // namespace palpate::deformation
