#include "deformation/volume/rules/element_volume.h"

#include <catch2/catch.hpp>

#include "method_checks.h"
#include "tests/deformation/analytic/plates.h"

namespace palpate::deformation {
namespace {

/// Largest |V_t − V_t₀|/V_t₀ of a ball held between plates.
double worst_element_error(OrganDynamics& dynamics, const OrganModel& model) {
  OrganState state = rest_state(model);
  testing::Plates plates(model, testing::kBallRadius);
  testing::squeeze(model, dynamics, 1e-3, 0.2, 0.5, 0.5, plates, state);
  double worst = 0;
  for (const Pyramid& pyramid : build_pyramids(model)) {
    const double volume = evaluate_pyramid(pyramid, state.positions).volume;
    worst = std::max(worst, std::abs(volume / pyramid.rest_volume - 1));
  }
  return worst;
}

TEST_CASE("element volume: a squeezed ball keeps each element, which one global volume does not") {
  // Oracle: between plates at 80 % of the height a pyramid under a plate of the same base has lost
  // a fifth; with the one constraint it may, with its own it must find room beside.
  auto organ = testing::ball_organ();
  organ.tissue.drag = 10;
  const auto model = testing::ball_model(2, organ);
  auto each = testing::stepped_by<ElementVolume>(model);
  auto whole = testing::stepped_by<ImplicitVolume>(model);
  CHECK(worst_element_error(whole, model) > 0.1);
  CHECK(worst_element_error(each, model) < 0.03);
}

TEST_CASE("element volume: on a tetrahedron every element follows the volume asked for") {
  // Oracle: V_t* = V_t₀ V*/V₀. Four constraints on fifteen coordinates can all be met; 1e-5 is what
  // four sweeps leave of the springs' pull in a step: stiffness of 1e2 N/m, h²/m of 1e-5 m/N.
  auto organ = testing::ball_organ();
  organ.springs.virtual_nodes = 1;
  const auto model = build_organ_model(organ, Vec3::Zero(), geometry::make_tetrahedron(0.1));
  auto method = testing::stepped_by<ElementVolume>(model);
  OrganState state = rest_state(model);
  state.target_volume *= 1.02;
  for (int s = 0; s < 500; ++s) method.step(1e-3, {}, state);
  for (const Pyramid& pyramid : build_pyramids(model)) {
    const double volume = evaluate_pyramid(pyramid, state.positions).volume;
    CHECK(std::abs(volume / (1.02 * pyramid.rest_volume) - 1) < 2e-5);
  }
}

}  // namespace
}  // namespace palpate::deformation
