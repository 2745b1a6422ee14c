// Laplace's law.
#include "deformation/symplectic_euler.h"
#include "tests/deformation/organs.h"

#include <catch2/catch.hpp>
#include <cmath>

namespace palpate::deformation {
namespace {

TEST_CASE("volume: an inflated spring sphere holds p = 2 T / r") {
  // Oracle: Laplace's law; on a mesh of equilateral triangles T = √3 k (l − l₀)/l, with
  // k = (√3/2) E t that is (3/2) E t ε/(1 + ε). 2 %: an icosphere's triangles are not equilateral.
  auto organ = testing::ball_organ();
  organ.springs.bending_ratio = 0;
  organ.springs.inner_ratio = 0;
  organ.tissue.drag = 30;  // settle fast
  organ.tissue.damping_ratio = 0.5;
  const auto model = testing::ball_model(3, organ);
  auto state = rest_state(model);
  const double strain = 0.05;
  state.target_volume = model.rest_volume * std::pow(1 + strain, 3);
  StepBuffers buffers;
  const double h = 0.9 * stable_step_bound(model);
  // The target is reached in small parts: a jump of V* is a jump of pressure ~ 1/h².
  const double target = state.target_volume;
  for (int s = 1; s <= 2000; ++s) {
    state.target_volume = model.rest_volume + (target - model.rest_volume) * s / 2000.0;
    symplectic_euler_step(model, h, {}, state, buffers);
  }
  for (int s = 0; s < 3000; ++s) symplectic_euler_step(model, h, {}, state, buffers);
  const double tension = 10e3 * 3e-3 / (1 - 1.0 / 3) * strain / (1 + strain);
  const double radius = testing::kBallRadius * (1 + strain);
  CHECK(state.pressure == Approx(2 * tension / radius).epsilon(0.02));
}

}  // namespace
}  // namespace palpate::deformation
