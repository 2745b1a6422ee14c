// An organ whose halves fly apart: motion about its mean, of a known kinetic energy.
#pragma once

#include "deformation/model/organ_model.h"
#include "deformation/model/organ_state.h"

namespace palpate::deformation::testing {

/// Each half of the model flies away from the other, at `speed` [m/s].
inline void tear(const Body& body, double speed, OrganState& state) {
  const auto side = [](const Vec3& p) { return (p.x() > 0) - (p.x() < 0); };
  for (std::size_t i = 0; i < body.node_count(); ++i) {
    state.velocities[i] = Vec3(side(body.rest_positions[i]) * speed, 0, 0);
  }
}

/// Least kinetic energy of two halves that do so, of the whole at that speed; some nodes stay.
inline double moving_share(const Body& body) {
  double moving = 0, mass = 0;
  for (std::size_t i = 0; i < body.node_count(); ++i) {
    mass += body.masses[i];
    if (body.rest_positions[i].x() != 0) moving += body.masses[i];
  }
  return moving / mass;
}

}  // namespace palpate::deformation::testing
