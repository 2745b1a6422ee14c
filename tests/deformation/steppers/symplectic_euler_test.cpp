#include "deformation/steppers/symplectic_euler.h"

#include <catch2/catch.hpp>

#include "deformation/springs/spring_forces.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

TEST_CASE("symplectic Euler: a free organ falls by g h² n(n+1)/2") {
  // Oracle: analytic, exact for the scheme.
  auto organ = testing::ball_organ();
  organ.tissue.drag = 0;
  const Vec3 gravity(0, 0, -9.81);
  const auto model = testing::ball_model(1, organ, gravity);
  auto state = rest_state(model);
  StepBuffers buffers;
  const double h = 1e-3;
  const int steps = 200;
  for (int s = 0; s < steps; ++s) symplectic_euler_step(model, h, {}, state, buffers);
  const Vec3 fall = 0.5 * steps * (steps + 1) * h * h * gravity;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    CHECK((state.positions[i] - model.rest_positions[i] - fall).norm() < 1e-9);
  }
}

TEST_CASE("symplectic Euler: drag slows a drifting organ at its stated rate") {
  // Oracle: v(t) = v₀ (1 − h α)ⁿ, exact for the scheme.
  auto organ = testing::ball_organ();
  organ.tissue.drag = 5;
  const auto model = testing::ball_model(1, organ);
  auto state = rest_state(model);
  for (Vec3& v : state.velocities) v = Vec3(1, 0, 0);
  StepBuffers buffers;
  for (int s = 0; s < 100; ++s) symplectic_euler_step(model, 1e-3, {}, state, buffers);
  const double expected = std::pow(1 - 5e-3, 100);
  for (const Vec3& v : state.velocities) CHECK(v.x() == Approx(expected).epsilon(1e-9));
}

TEST_CASE("symplectic Euler: fixed nodes never move and the rest is in equilibrium at rest") {
  // Oracle: invariant.
  auto organ = testing::ball_organ();
  organ.fixed.push_back(scene::SphereRegion{Vec3(0, 0, 0.05), 0.03});
  const auto model = testing::ball_model(2, organ);
  auto state = rest_state(model);
  StepBuffers buffers;
  for (int s = 0; s < 100; ++s) symplectic_euler_step(model, 1e-3, {}, state, buffers);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    CHECK((state.positions[i] - model.rest_positions[i]).norm() < 1e-12);
  }
}

/// Largest |V−V*|/V* of a ball set swinging (quadrupole mode) over half a second.
double worst_volume_error(bool preserve) {
  const auto model = testing::ball_model(2);
  auto state = rest_state(model);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3& p = model.rest_positions[i];
    state.velocities[i] = 6 * Vec3(p.x(), p.y(), p.z());  // breathing: all volume
  }
  StepBuffers buffers;
  double worst = 0;
  for (int s = 0; s < 500; ++s) {
    symplectic_euler_step(model, 1e-3, {}, state, buffers, {.is_kept = preserve});
    const double volume = geometry::enclosed_volume(state.positions, model.triangles);
    worst = std::max(worst, std::abs(volume / model.rest_volume - 1));
  }
  return worst;
}

TEST_CASE("symplectic Euler: the constraint keeps what plain springs lose") {
  // Oracle: V = V₀ (1 + …): the constraint is exact to first order, its error per step is of
  // second order in h·speed/radius = 1e-3·0.3/0.05.
  CHECK(worst_volume_error(true) < 5e-5);
  CHECK(worst_volume_error(false) > 0.05);
}

TEST_CASE("symplectic Euler: without forces from outside momentum is kept") {
  // Oracle: invariant, volume constraint on and springs swinging.
  auto organ = testing::ball_organ();
  organ.tissue.drag = 0;
  const auto model = testing::ball_model(2, organ);
  auto state = rest_state(model);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3& p = model.rest_positions[i];
    state.velocities[i] = Vec3(0.1 + p.y(), 3 * p.z(), -p.x());
  }
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < model.node_count(); ++i)
      sum += model.masses[i] * state.velocities[i];
    return sum;
  };
  const Vec3 before = momentum();
  StepBuffers buffers;
  for (int s = 0; s < 300; ++s) symplectic_euler_step(model, 1e-3, {}, state, buffers);
  CHECK((momentum() - before).norm() < 1e-12);
}

TEST_CASE("symplectic Euler: the same steps give the same bits") {
  // Oracle: itself, run twice.
  const auto model = testing::ball_model(2);
  const auto run = [&] {
    auto state = rest_state(model);
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      state.velocities[i] = Vec3(std::sin(static_cast<double>(i)), 0.1, -0.1);
    }
    StepBuffers buffers;
    for (int s = 0; s < 200; ++s) symplectic_euler_step(model, 1e-3, {}, state, buffers);
    return state;
  };
  const auto first = run(), second = run();
  CHECK(first.positions == second.positions);
  CHECK(first.velocities == second.velocities);
  CHECK(first.pressure == second.pressure);
}

}  // namespace
}  // namespace palpate::deformation
