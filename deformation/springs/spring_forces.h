// Forces and energy of the spring network.
#pragma once

#include <vector>

#include "deformation/model/organ_state.h"
#include "deformation/model/spring_network.h"

namespace palpate::deformation {

/// Adds to `forces` [N] (node_count) of each spring with ends a, b, length l and direction
/// u = (x_b − x_a)/l:   f_a += (k (l − l₀) + c (v_b − v_a)·u) u,   f_b −= the same.
/// Both act along the spring, so momentum and angular momentum are kept. A spring of zero length
/// has no direction and gives no force.
void add_spring_forces(const SpringNetwork& network, const OrganState& state,
                       std::vector<Vec3>& forces);

double elastic_energy(const SpringNetwork& network,
                      const std::vector<Vec3>& positions);  ///< Σ ½k(l−l₀)² [J]

}  // namespace palpate::deformation
