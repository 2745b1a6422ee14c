#include "deformation/springs/spring_forces.h"

#include <cmath>

namespace palpate::deformation {

void add_spring_forces(const SpringNetwork& network, const OrganState& state,
                       std::vector<Vec3>& forces) {
  const auto& springs = network.springs;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    const Spring& spring = springs[s];
    const Vec3 along = state.positions[spring.node_b] - state.positions[spring.node_a];
    const double length = std::sqrt(along.squaredNorm());
    if (length == 0) continue;
    const double inverse_length = 1 / length;
    const Vec3 closing = state.velocities[spring.node_b] - state.velocities[spring.node_a];
    const double tension = spring.stiffness * (length - spring.rest_length) +
                           network.damping[s] * (closing.dot(along) * inverse_length);
    const Vec3 force = (tension * inverse_length) * along;
    forces[spring.node_a] += force;
    forces[spring.node_b] -= force;
  }
}

double elastic_energy(const SpringNetwork& network, const std::vector<Vec3>& positions) {
  double energy = 0;
  for (const Spring& spring : network.springs) {
    const double stretch =
        (positions[spring.node_b] - positions[spring.node_a]).norm() - spring.rest_length;
    energy += 0.5 * spring.stiffness * stretch * stretch;
  }
  return energy;
}

}  // namespace palpate::deformation
