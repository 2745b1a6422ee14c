// Solids for the tests of this folder, made without Gmsh.
#pragma once

#include <cmath>

#include "deformation/elements/taylor_hood.h"
#include "modules/core/error.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::deformation::testing {

using geometry::testing::block;
using geometry::testing::without_gmsh;

/// A number in −1 … 1 that depends on i only.
inline double noise(std::size_t i) {
  return std::sin(12.9898 * static_cast<double>(i + 1) * 78.233);
}

/// Nodes strictly inside moved by up to `amount`.
inline void shake_interior(geometry::TetMesh& mesh, const Vec3& size, double amount) {
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Vec3 p = mesh.nodes[i];
    if ((p.array() <= 0).any() || (p.array() >= size.array()).any()) continue;
    mesh.nodes[i] += amount * Vec3(noise(3 * i), noise(3 * i + 1), noise(3 * i + 2));
  }
}

inline TaylorHoodElements solid(const geometry::TetMesh& mesh, double poisson_ratio) {
  return {make_quadratic(mesh), ElasticConstants(3000, poisson_ratio), 1000};
}

/// Some state away from rest, J > 0.
inline SolidState shaken(const TaylorHoodElements& solid, double amount) {
  auto state = solid.rest_state();
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    state.positions[i] += amount * Vec3(noise(3 * i), noise(3 * i + 1), noise(3 * i + 2));
  }
  for (Eigen::Index m = 0; m < state.pressures.size(); ++m) {
    state.pressures[m] = 300 * noise(static_cast<std::size_t>(m));
  }
  return state;
}

/// x = 0, y = 0 and z = 0 are planes of symmetry.
inline std::vector<char> symmetry(const TaylorHoodElements& solid) {
  std::vector<char> held;
  for (const Vec3& p : solid.mesh().nodes) {
    for (int axis = 0; axis < 3; ++axis) held.push_back(p[axis] == 0);
  }
  return held;
}

}  // namespace palpate::deformation::testing
