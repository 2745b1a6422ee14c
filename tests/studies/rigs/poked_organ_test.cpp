#include "studies/rigs/poked_organ.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"

namespace palpate::rigs {
namespace {

TEST_CASE("poked organ: the front is what a line along y meets first") {
  // Oracle: analytic; a ball cut where x² + z² = 3² + 4² of its radius in hundredths.
  const auto ball = geometry::make_ball(0.1, 4);
  CHECK(front_of(ball, 0.03, 0.04) == Approx(-std::sqrt(0.0075)).epsilon(2e-3));
  const PokedPlace place{"", 0.03, 0.04};
  const Vec3 touching = poker_at(ball, place, 0), deeper = poker_at(ball, place, 2e-3);
  CHECK(touching.y() == front_of(ball, 0.03, 0.04) - kPokerRadius);
  CHECK((deeper - touching - Vec3(0, 2e-3, 0)).norm() < 1e-15);
}

TEST_CASE("poked organ: both organs are there to be poked, and held") {
  // Oracle: the shipped scenes; what is poked lies between the surface's lowest and highest y.
  for (const PokedPlace& place : {kOnLiver, kOnStomach}) {
    const scene::Organ organ = poked_organ(place);
    CHECK_FALSE(organ.fixed.empty());
    const auto surface = surface_of(organ, 150);
    double least = 1, most = -1;
    for (const Vec3& node : surface.nodes) {
      least = std::min(least, node.y());
      most = std::max(most, node.y());
    }
    const double front = front_of(surface, place.x, place.z);
    CHECK(front >= least);
    CHECK(front < most);
  }
}

}  // namespace
}  // namespace palpate::rigs
