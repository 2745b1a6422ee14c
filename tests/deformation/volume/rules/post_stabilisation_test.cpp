#include "deformation/volume/rules/post_stabilisation.h"

#include <catch2/catch.hpp>

#include "method_checks.h"

namespace palpate::deformation {
namespace {

/// Volume error that one step from rest with these velocities leaves.
double error_after_step(double h) {
  const auto model = testing::ball_model(2);
  auto method = testing::stepped_by<PostStabilisation>(model);
  OrganState state = testing::shaken_state(model, 0, 0);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3& p = state.positions[i];
    state.velocities[i] = 20 * Vec3(p.x(), p.y(), -2 * p.z());
  }
  method.step(h, {}, state);
  return std::abs(testing::volume_of(model, state) / model.rest_volume - 1);
}

TEST_CASE("post-stabilisation: what a step leaves is of fourth order in h") {
  // Oracle: drift O(h²) squared by one Newton step; halving h divides it by 16, up to the next
  // order (h·20/s = 4 %).
  const double coarse = error_after_step(2e-3), fine = error_after_step(1e-3);
  CHECK(coarse > 1e-10);  // above rounding
  CHECK(coarse / fine == Approx(16).epsilon(0.15));
}

TEST_CASE("post-stabilisation: the projection moves positions, not velocities") {
  // Oracle: at rest, springs at their rest lengths, only V* is off: the velocity constraint
  // g·v = 0 holds already, so nothing may get a velocity (1e-7 m/s: rounding of springs).
  const auto model = testing::ball_model(2);
  auto method = testing::stepped_by<PostStabilisation>(model);
  OrganState state = rest_state(model);
  state.target_volume *= 1.01;
  method.step(1e-3, {}, state);
  CHECK(std::abs(testing::volume_of(model, state) / state.target_volume - 1) < 1e-4);
  for (const Vec3& v : state.velocities) CHECK(v.norm() < 1e-7);
}

}  // namespace
}  // namespace palpate::deformation
