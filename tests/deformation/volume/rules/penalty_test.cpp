#include "deformation/volume/rules/penalty.h"

#include <catch2/catch.hpp>

#include "method_checks.h"
#include "tests/deformation/analytic/plates.h"

namespace palpate::deformation {
namespace {

TEST_CASE("penalty: held between plates the volume is wrong by p/K") {
  // Oracle: p of the implicit constraint, which keeps the volume. With K = 1 MPa the volume lost
  // (4e-5) changes p by less than 1 %, what is left of the motion by less still.
  auto organ = testing::ball_organ();
  organ.tissue.drag = 10;
  const auto model = testing::ball_model(2, organ);
  constexpr double kModulus = 1e6;
  auto penalty = testing::stepped_by<Penalty>(model, kModulus);
  auto constraint = testing::stepped_by<ImplicitVolume>(model);
  const double h = penalty.largest_step();
  REQUIRE(h > 1e-4);
  double pressures[2], errors[2];
  OrganDynamics* const both[] = {&penalty, &constraint};
  for (int k = 0; k < 2; ++k) {
    OrganState state = rest_state(model);
    testing::Plates plates(model, testing::kBallRadius);
    testing::squeeze(model, *both[k], h, 0.3, 1, 1, plates, state);
    pressures[k] = state.pressure;
    errors[k] = 1 - testing::volume_of(model, state) / model.rest_volume;
  }
  REQUIRE(pressures[1] > 20);
  CHECK(errors[0] == Approx(pressures[1] / kModulus).epsilon(0.01));
  CHECK(pressures[0] == Approx(pressures[1]).epsilon(0.01));
}

TEST_CASE("penalty: its forces are minus the gradient of its energy") {
  const auto model = testing::ball_model(2);
  auto penalty = testing::stepped_by<Penalty>(model);
  const auto state = testing::shaken_state(model, 3e-3, 0.1);
  testing::check_forces_are_minus_gradient(
      model, penalty, state, [&](const OrganState& s) { return penalty.stored_energy(s); });
}

TEST_CASE("penalty: the step it takes is stable however stiff, twice that is not") {
  // Oracle: the bound. One stiff mode is all the contents are, so the bound is nearly reached.
  const auto model = testing::ball_model(1, testing::undamped_ball_with("penalty"));
  auto penalty = testing::stepped_by<Penalty>(model, 1e7);
  const auto final_error = [&](double h) {
    OrganState state = rest_state(model);
    testing::scale(state, 1.001);
    for (int s = 0; s < 2000; ++s) penalty.step(h, {}, state);
    return std::abs(testing::volume_of(model, state) / model.rest_volume - 1);
  };
  CHECK(final_error(penalty.largest_step()) < 0.02);
  CHECK_FALSE(final_error(2 * penalty.largest_step()) < 0.02);
}

}  // namespace
}  // namespace palpate::deformation
