// Tetrahedra for tests, made without Gmsh.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "modules/geometry/tet_mesh.h"

namespace palpate::geometry::testing {

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

/// Σ of its tetrahedra [m³]; each must be positive.
template <class NodeAt>
double volume_of(const std::vector<Tetrahedron>& tetrahedra, const NodeAt& node) {
  double volume = 0, least = 1;
  for (const auto& [a, b, c, d] : tetrahedra) {
    const double part = tetrahedron_volume(node(a), node(b), node(c), node(d));
    least = std::min(least, part);
    volume += part;
  }
  CHECK(least > 0);
  return volume;
}
inline double volume_of(const TetMesh& mesh) {
  return volume_of(mesh.tetrahedra, [&](std::uint32_t i) { return mesh.nodes[i]; });
}

/// True, and says so, where Gmsh is not installed.
inline bool without_gmsh() {
  if (std::system("gmsh --version >/dev/null 2>&1") == 0) return false;
  std::printf("SKIPPED: gmsh is not installed\n");
  return true;
}

}  // namespace palpate::geometry::testing
