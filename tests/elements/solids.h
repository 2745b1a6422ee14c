// Solids for the tests of this folder, made without Gmsh.
#pragma once

#include <cmath>
#include <cstdio>

#include "deformation/elements/mixed_solid.h"
#include "modules/core/error.h"

namespace palpate::elements::testing {

/// Block from the origin, every cube of the grid in six tetrahedra (Kuhn's).
inline TetMesh block(const Vec3& size, int nx, int ny, int nz) {
  TetMesh mesh;
  const auto at = [&](int i, int j, int k) {
    return static_cast<std::uint32_t>(i + (nx + 1) * (j + (ny + 1) * k));
  };
  for (int k = 0; k <= nz; ++k) {
    for (int j = 0; j <= ny; ++j) {
      for (int i = 0; i <= nx; ++i) {
        mesh.nodes.emplace_back(size.x() * i / nx, size.y() * j / ny, size.z() * k / nz);
      }
    }
  }
  constexpr int kPaths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        for (int p = 0; p < 6; ++p) {
          int at_corner[3] = {i, j, k};
          Tetrahedron corners{at(i, j, k)};
          for (std::size_t s = 0; s < 3; ++s) {
            ++at_corner[kPaths[p][s]];
            corners[s + 1] = at(at_corner[0], at_corner[1], at_corner[2]);
          }
          if (p >= 3) std::swap(corners[2], corners[3]);  // odd permutations are inside out
          mesh.tetrahedra.push_back(corners);
        }
      }
    }
  }
  return mesh;
}

/// A number in −1 … 1 that depends on i only.
inline double noise(std::size_t i) {
  return std::sin(12.9898 * static_cast<double>(i + 1) * 78.233);
}

/// Nodes strictly inside moved by up to `amount`.
inline void shake_interior(TetMesh& mesh, const Vec3& size, double amount) {
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Vec3 p = mesh.nodes[i];
    if ((p.array() <= 0).any() || (p.array() >= size.array()).any()) continue;
    mesh.nodes[i] += amount * Vec3(noise(3 * i), noise(3 * i + 1), noise(3 * i + 2));
  }
}

inline MixedSolid solid(const TetMesh& mesh, double poissons_ratio) {
  return {make_quadratic(mesh), NeoHookean::from_engineering(3000, poissons_ratio), 1000};
}

/// Some state away from rest, J > 0.
inline SolidState shaken(const MixedSolid& solid, double amount) {
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
inline std::vector<char> symmetry(const MixedSolid& solid) {
  std::vector<char> held;
  for (const Vec3& p : solid.mesh().nodes) {
    for (int axis = 0; axis < 3; ++axis) held.push_back(p[axis] == 0);
  }
  return held;
}

/// True, and says so, where Gmsh is not installed.
inline bool without_gmsh() {
  if (std::system("gmsh --version >/dev/null 2>&1") == 0) return false;
  std::printf("SKIPPED: gmsh is not installed\n");
  return true;
}

}  // namespace palpate::elements::testing
