#include "deformation/springs/spring_forces.h"

#include <catch2/catch.hpp>
#include <random>

#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

OrganState disturbed(const OrganModel& model, unsigned seed, double amplitude) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  auto state = rest_state(model);
  for (auto& p : state.positions)
    p += amplitude * Vec3(uniform(random), uniform(random), uniform(random));
  for (auto& v : state.velocities) v = Vec3(uniform(random), uniform(random), uniform(random));
  return state;
}

TEST_CASE("spring forces: are minus the gradient of the elastic energy") {
  // Oracle: central differences; step 1e-7 of a 1e-2 m edge leaves 1e-6 relative.
  auto organ = testing::ball_organ();
  organ.tissue.damping_ratio = 0;
  const auto model = testing::ball_model(1, organ);
  auto state = disturbed(model, 1, 2e-3);
  std::vector<Vec3> forces(model.node_count(), Vec3::Zero());
  add_spring_forces(model.network(), state, forces);
  const double step = 1e-7;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      auto x = state.positions;
      x[i][axis] += step;
      const double up = elastic_energy(model.network(), x);
      x[i][axis] -= 2 * step;
      const double down = elastic_energy(model.network(), x);
      CHECK(forces[i][axis] == Approx(-(up - down) / (2 * step)).epsilon(1e-5).margin(1e-8));
    }
  }
}

TEST_CASE("spring forces: keep momentum and angular momentum, damping included") {
  // Oracle: invariant, to rounding of sums of about 1 N.
  const auto model = testing::ball_model(2);
  const auto state = disturbed(model, 2, 5e-3);
  std::vector<Vec3> forces(model.node_count(), Vec3::Zero());
  add_spring_forces(model.network(), state, forces);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  double size = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    force += forces[i];
    torque += state.positions[i].cross(forces[i]);
    size += forces[i].norm();
  }
  CHECK(force.norm() < 1e-13 * size);
  CHECK(torque.norm() < 1e-13 * size);
}

TEST_CASE("spring forces: damping takes energy out and nothing else") {
  // Oracle: invariant. Power of the damping part is ≤ 0; it vanishes in rigid motion.
  auto organ = testing::ball_organ();
  const auto damped = testing::ball_model(1, organ);
  organ.tissue.damping_ratio = 0;
  const auto elastic = testing::ball_model(1, organ);
  auto state = disturbed(damped, 3, 0);
  const auto damping_force = [&](const OrganState& s) {
    std::vector<Vec3> with(damped.node_count(), Vec3::Zero()), without = with;
    add_spring_forces(damped.network(), s, with);
    add_spring_forces(elastic.network(), s, without);
    for (std::size_t i = 0; i < with.size(); ++i) with[i] -= without[i];
    return with;
  };
  double power = 0;
  const auto forces = damping_force(state);
  for (std::size_t i = 0; i < forces.size(); ++i) power += forces[i].dot(state.velocities[i]);
  CHECK(power < -1e-3);

  for (std::size_t i = 0; i < state.velocities.size(); ++i) {
    state.velocities[i] = Vec3(0.1, 0.2, -0.3) + Vec3(1, -2, 0.5).cross(state.positions[i]);
  }
  for (const Vec3& f : damping_force(state)) CHECK(f.norm() < 1e-12);
}

TEST_CASE("spring forces: a collapsed spring gives no force and no NaN") {
  // Oracle: definition.
  const auto model = testing::ball_model(0);
  auto state = rest_state(model);
  for (auto& p : state.positions) p = Vec3(0.1, 0.2, 0.3);
  std::vector<Vec3> forces(model.node_count(), Vec3::Zero());
  add_spring_forces(model.network(), state, forces);
  for (const Vec3& f : forces) CHECK(f == Vec3::Zero());
}

TEST_CASE("kinetic energy: of a rigid translation is ½ M v²") {
  // Oracle: analytic.
  const auto model = testing::ball_model(1);
  const std::vector<Vec3> velocities(model.node_count(), Vec3(0, 0, 2));
  CHECK(kinetic_energy(model, velocities) ==
        Approx(2 * testing::ball_organ().tissue.density * model.rest_volume).epsilon(1e-12));
}

}  // namespace
}  // namespace palpate::deformation
