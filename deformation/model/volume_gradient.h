// The volume a body encloses, and how it changes with each node.
#pragma once

#include <vector>

#include "deformation/model/body.h"

namespace palpate::deformation {

struct VolumeGradient {
  double volume = 0;           ///< V [m³]
  std::vector<Vec3> gradient;  ///< g_i = ∂V/∂x_i [m²]  (surface_node_count)
  double denominator = 0;      ///< gᵀM⁻¹g [m⁴/kg]
};

/// V, g and gᵀM⁻¹g at these positions, taken about a node of the surface so that an organ far from
/// the origin keeps its digits.
void evaluate_volume(const Body& body, const std::vector<Vec3>& positions, VolumeGradient& out);

}  // namespace palpate::deformation
