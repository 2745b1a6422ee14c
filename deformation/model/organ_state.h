// What changes while an organ deforms.
#pragma once

#include <limits>
#include <vector>

#include "deformation/model/body.h"
#include "deformation/model/internal_state.h"
#include "modules/core/state_archive.h"

namespace palpate::deformation {

struct OrganState {
  std::vector<Vec3> positions;   ///< surface nodes, then those inside, in W [m]
  std::vector<Vec3> velocities;  ///< [m/s]
  double volume = 0;             ///< of the positions [m³]
  double target_volume = 0;      ///< V* [m³]
  /// A kept volume is let go for a step that would need |p| above this [Pa]: the contents then push
  /// with just so much, and the volume becomes what it becomes. Not below 0.
  double pressure_limit = std::numeric_limits<double>::infinity();
  double pressure = 0;  ///< p = −λ of the last step [Pa]
  InternalState internal;

  void exchange(StateArchive& archive) {
    archive(positions, velocities, volume, target_volume, pressure_limit, pressure, internal);
  }
};

/// At rest, with the rest volume as target.
inline OrganState rest_state(const Body& body) {
  OrganState state;
  state.positions = body.rest_positions;
  state.velocities.assign(body.node_count(), Vec3::Zero());
  state.volume = state.target_volume = body.rest_volume;
  return state;
}

inline double kinetic_energy(const Body& body, const std::vector<Vec3>& velocities) {
  double energy = 0;
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    energy += 0.5 * body.masses[i] * velocities[i].squaredNorm();
  }
  return energy;
}

}  // namespace palpate::deformation
