#include "deformation/volume/rules/promayon.h"

#include <catch2/catch.hpp>

#include "method_checks.h"

namespace palpate::deformation {
namespace {

TEST_CASE("Promayon: the volume is exact after every step, however wild") {
  // Oracle: the cubic is exact; 1e-13 is rounding of 80 triangles' volumes. Velocities are those
  // of the motion made.
  const auto model = testing::ball_model(1);
  auto promayon = testing::stepped_by<Promayon>(model);
  OrganState state = testing::shaken_state(model, 3e-3, 1);
  const double h = 1e-3;
  for (int s = 0; s < 200; ++s) {
    const auto before = state.positions;
    CHECK_FALSE(promayon.step(h, {}, state).volume_skipped);
    CHECK(std::abs(testing::volume_of(model, state) / model.rest_volume - 1) < 1e-13);
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      REQUIRE((state.positions[i] - before[i] - h * state.velocities[i]).norm() < 1e-15);
    }
  }
}

TEST_CASE("Promayon: the reaction is the pressure of the contents") {
  // Oracle: the implicit constraint's pressure on the same ball inflated by 5 %, at rest; both are
  // then the springs' (p = 2 T/r in the inflated sphere's test).
  const auto model = testing::ball_model(2);
  auto promayon = testing::stepped_by<Promayon>(model);
  auto constraint = testing::stepped_by<ImplicitVolume>(model);
  OrganState state = rest_state(model);
  state.target_volume *= 1.05;
  OrganState other = state;
  for (int s = 0; s < 2000; ++s) {
    promayon.step(1e-3, {}, state);
    constraint.step(1e-3, {}, other);
  }
  REQUIRE(other.pressure > 1);
  CHECK(state.pressure == Approx(other.pressure).epsilon(1e-3));
}

}  // namespace
}  // namespace palpate::deformation
