// How a tetrahedron's mass is lumped at its nodes.
#pragma once

#include "deformation/model/tet_mesh.h"

namespace palpate::deformation {

/// Hinton's shares of a straight quadratic tetrahedron: diagonals 1/70 and 4/105 of the consistent
/// mass, scaled to a sum of 1.
inline constexpr double kQuadraticCornerShare = 1.0 / 36, kQuadraticMiddleShare = 4.0 / 27;

/// [kg]
inline double tetrahedron_mass(const TetMesh& mesh, std::size_t e,
                               const std::vector<Vec3>& rest_positions) {
  const auto& [a, b, c, d] = mesh.tetrahedra[e];
  return mesh.density * geometry::tetrahedron_volume(rest_positions[a], rest_positions[b],
                                                     rest_positions[c], rest_positions[d]);
}

}  // namespace palpate::deformation
