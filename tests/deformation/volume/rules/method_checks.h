// What several methods are tested by.
#pragma once

#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "deformation/models.h"
#include "deformation/steppers/symplectic_euler.h"
#include "deformation/volume/implicit_volume.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation::testing {

/// Symplectic Euler with such a rule.
template <class Rule, class... More>
SymplecticEuler stepped_by(const OrganModel& model, More... more) {
  return {model, std::make_unique<Rule>(model, more...)};
}

inline scene::Organ ball_organ_with(const std::string& method) {
  auto organ = ball_organ();
  organ.model = method;
  return organ;
}

/// Neither drag nor damping.
inline scene::Organ undamped_ball_with(const std::string& method) {
  auto organ = ball_organ_with(method);
  organ.tissue.drag = organ.tissue.damping_ratio = 0;
  return organ;
}

/// Rest positions and zero velocities, each coordinate off by up to `by`. Same every time.
inline OrganState shaken_state(const OrganModel& model, double by_metres, double by_speed) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  OrganState state = rest_state(model);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    if (model.inverse_masses[i] == 0) continue;
    state.positions[i] += by_metres * Vec3(any(random), any(random), any(random));
    state.velocities[i] += by_speed * Vec3(any(random), any(random), any(random));
  }
  return state;
}

inline void scale(OrganState& state, double factor) {
  for (Vec3& x : state.positions) x *= factor;
}

inline double volume_of(const OrganModel& model, const OrganState& state) {
  return geometry::enclosed_volume(state.positions, model.triangles);
}

/// Forces [N] of a method beyond the springs, from one step without contacts.
inline std::vector<Vec3> method_forces(const OrganModel& model, OrganDynamics& dynamics,
                                       const OrganState& at, double h = 1e-4) {
  OrganState with = at, without = at;
  dynamics.step(h, {}, with);
  std::vector<Vec3> forces;
  apply_forces(model, h, without, forces);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    forces[i] = model.masses[i] / h * (with.velocities[i] - without.velocities[i]);
  }
  return forces;
}

/// Oracle: finite differences. The forces are minus the gradient of `energy`, along a random
/// direction; central differences of 1e-6 m are good to 1e-6 here.
template <class Energy>
void check_forces_are_minus_gradient(const OrganModel& model, OrganDynamics& dynamics,
                                     const OrganState& at, const Energy& energy) {
  const auto forces = method_forces(model, dynamics, at);
  const auto direction = shaken_state(model, 0, 1).velocities;
  constexpr double kStep = 1e-6;
  OrganState ahead = at, behind = at;
  double power = 0;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    ahead.positions[i] += kStep * direction[i];
    behind.positions[i] -= kStep * direction[i];
    power += forces[i].dot(direction[i]);
  }
  CHECK(power == Approx(-(energy(ahead) - energy(behind)) / (2 * kStep)).epsilon(1e-5));
}

}  // namespace palpate::deformation::testing
