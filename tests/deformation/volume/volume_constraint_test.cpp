#include "deformation/volume/volume_constraint.h"

#include <catch2/catch.hpp>

#include "deformation/model/volume_gradient.h"
#include "deformation/steppers/symplectic_euler.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

TEST_CASE("volume: gradient agrees with finite differences") {
  // Oracle: central differences. V is cubic: only rounding remains, 1e-7 relative to the largest.
  const auto model = testing::ball_model(1);
  auto x = model.rest_positions;
  VolumeGradient at;
  evaluate_volume(model, x, at);
  const double step = 1e-6;
  for (std::size_t i = 0; i < model.surface_node_count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      auto moved = x;
      VolumeGradient up, down;
      moved[i][axis] += step;
      evaluate_volume(model, moved, up);
      moved[i][axis] -= 2 * step;
      evaluate_volume(model, moved, down);
      CHECK(at.gradient[i][axis] ==
            Approx((up.volume - down.volume) / (2 * step)).epsilon(1e-6).margin(1e-11));
    }
  }
}

TEST_CASE("volume: Σ g = 0, Σ x·g = 3 V, and a far organ keeps its digits") {
  // Oracle: identities of a closed surface; 1 km away doubles keep 1e-13 m of a 0.05 m organ.
  const auto model = testing::ball_model(2);
  const Vec3 shift = GENERATE(Vec3(0, 0, 0), Vec3(1000, -1000, 1000));
  auto x = model.rest_positions;
  for (Vec3& p : x) p += shift;
  VolumeGradient at;
  evaluate_volume(model, x, at);
  Vec3 sum = Vec3::Zero();
  double moment = 0;
  for (std::size_t i = 0; i < model.surface_node_count; ++i) {
    sum += at.gradient[i];
    moment += (x[i] - shift).dot(at.gradient[i]);
  }
  CHECK(sum.norm() < 1e-16);
  CHECK(moment == Approx(3 * at.volume).epsilon(1e-10));
  CHECK(at.volume == Approx(model.rest_volume).epsilon(1e-10));
}

TEST_CASE("volume: one step solves the printed scalar equation for λ") {
  // Oracle: (gᵀM⁻¹g) λ = Φ/h² + g·(v/h + M⁻¹F) evaluated here term by term; p = −λ.
  auto organ = testing::ball_organ();
  organ.tissue.drag = 0;
  organ.tissue.damping_ratio = 0;
  const Vec3 gravity(0.3, -0.2, -9.81);
  const auto model = testing::ball_model(1, organ, gravity);
  auto state = rest_state(model);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    state.velocities[i] = 0.1 * state.positions[i] + Vec3(0, 0.01, 0);
  }
  state.target_volume *= 1.001;
  VolumeGradient at;
  evaluate_volume(model, state.positions, at);
  const double h = 1e-3;
  double right = (at.volume - state.target_volume) / (h * h);
  for (std::size_t i = 0; i < model.surface_node_count; ++i) {
    right += at.gradient[i].dot(state.velocities[i] / h + gravity);  // springs at rest: F = m g
  }
  StepBuffers buffers;
  symplectic_euler_step(model, h, {}, state, buffers);
  CHECK(state.pressure == Approx(-right / at.denominator).epsilon(1e-9));
}

}  // namespace
}  // namespace palpate::deformation
