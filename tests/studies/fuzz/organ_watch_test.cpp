#include "studies/fuzz/organ_watch.h"

#include <catch2/catch.hpp>

#include "deformation/organ_messages.h"
#include "modules/core/tolerances.h"
#include "studies/fuzz/outcome.h"
#include "tests/deformation/organs.h"

namespace palpate::fuzz {
namespace {

namespace world_of = deformation::testing;

constexpr double kMass = 0.1;  // [kg]

TEST_CASE("organ watch: an organ at rest is fine, one back at rest without a word is not") {
  // Oracle: definition. A plate dents the ball; reset() puts it back.
  deformation::DeformationWorld world(world_of::ball_scene(1),
                                      {geometry::make_ball(world_of::kBallRadius, 1)});
  const double period = 4e-3;
  OrganWatch watch(deformation::surface_message(world, 0), 2 * world_of::kBallRadius, kMass,
                   period);
  const auto nodes = [&] {
    NodePositions now;
    deformation::write_node_positions(world, 0, now);
    return now;
  };
  CHECK_NOTHROW(watch.look_last());
  for (int k = 0; k < 20; ++k) {
    const double height = world_of::kBallRadius - 2e-4 * k;
    world.set_contacts(world_of::plate_contacts(world, 0, height, 1, 2e-3));
    world.set_probe(0, Pose{Vec3(0, 0, height), Quat::Identity()});
    world.advance(period);
    REQUIRE_NOTHROW(watch.look(nodes(), false));
  }
  CHECK_NOTHROW(watch.look_last());
  world.reset();
  CHECK_THROWS_AS(watch.look(nodes(), false), Failure);
}

TEST_CASE("organ watch: an organ that shakes within an advance is shaking, one that flies is not") {
  // Oracle: m v²/2. Its surface is where it was an advance ago, or as far from there as it flew.
  deformation::DeformationWorld world(world_of::ball_scene(1),
                                      {geometry::make_ball(world_of::kBallRadius, 1)});
  const double period = 4e-3, fast = 1.1 * kMaxProbeSpeed;
  for (const bool flies : {false, true}) {
    OrganWatch watch(deformation::surface_message(world, 0), 2 * world_of::kBallRadius, kMass,
                     period);
    NodePositions now;
    deformation::write_node_positions(world, 0, now);
    now.kinetic_energy = kMass * fast * fast / 2;
    watch.look(now, false);
    for (std::size_t k = 0; flies && k < now.positions.size(); k += 3) {
      now.positions[k] += static_cast<float>(fast * period);
    }
    watch.look(now, false);
    if (flies) {
      CHECK_NOTHROW(watch.look_last());
    } else {
      CHECK_THROWS_AS(watch.look_last(), Failure);
    }
  }
}

}  // namespace
}  // namespace palpate::fuzz
