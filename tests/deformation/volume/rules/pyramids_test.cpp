#include "deformation/volume/rules/pyramids.h"

#include <catch2/catch.hpp>

#include "method_checks.h"

namespace palpate::deformation {
namespace {

TEST_CASE("pyramids: they fill the organ, whatever its shape") {
  // Oracle: enclosed_volume(), independent of where the apex is.
  const auto model = testing::ball_model(2);
  const auto pyramids = build_pyramids(model);
  REQUIRE(pyramids.size() == model.triangles.size());
  const auto state = testing::shaken_state(model, 0.02, 0);
  double rest = 0, deformed = 0, shares = 0;
  for (const Pyramid& pyramid : pyramids) {
    CHECK(pyramid.rest_volume > 0);
    rest += pyramid.rest_volume;
    deformed += evaluate_pyramid(pyramid, state.positions).volume;
    shares += pyramid.area_share;
  }
  CHECK(rest == Approx(model.rest_volume).epsilon(1e-12));
  CHECK(deformed == Approx(testing::volume_of(model, state)).epsilon(1e-12));
  CHECK(shares == Approx(1).epsilon(1e-12));
}

TEST_CASE("pyramids: the gradient is that of the volume and moves nothing as a whole") {
  // Oracle: central differences, exact for a function linear in each node; invariant Σ g = 0.
  const auto model = testing::ball_model(1);
  auto positions = testing::shaken_state(model, 0.01, 0).positions;
  const Pyramid pyramid = build_pyramids(model)[5];
  const auto at = evaluate_pyramid(pyramid, positions);
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    sum += at.gradient[k];
    for (int axis = 0; axis < 3; ++axis) {
      double& x = positions[pyramid.nodes[k]][axis];
      const double kept = x, step = 1e-4;
      x = kept + step;
      const double ahead = evaluate_pyramid(pyramid, positions).volume;
      x = kept - step;
      const double behind = evaluate_pyramid(pyramid, positions).volume;
      x = kept;
      CHECK(at.gradient[k][axis] == Approx((ahead - behind) / (2 * step)).margin(1e-15));
    }
  }
  CHECK(sum.norm() < 1e-18);
}

}  // namespace
}  // namespace palpate::deformation
