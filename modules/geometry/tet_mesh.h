// Tetrahedral meshes: corners only.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

using Tetrahedron = std::array<std::uint32_t, 4>;

/// Corners of the faces, each outward if the tetrahedron's volume is positive.
inline constexpr std::array<std::array<int, 3>, 4> kTetrahedronFaces{
    {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};

/// Corners of the edges whose middle nodes follow the four corners of a quadratic tetrahedron.
inline constexpr std::array<std::array<int, 2>, 6> kTetrahedronEdges{
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

struct TetMesh {
  std::vector<Vec3> nodes;              ///< [m]
  std::vector<Tetrahedron> tetrahedra;  ///< each of positive volume
};

/// (b−a)×(c−a)·(d−a)/6 [m³]
double tetrahedron_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

struct BoundaryTriangle {
  Triangle nodes{};               ///< outward
  std::uint32_t tetrahedron = 0;  ///< it belongs to
  int face = 0;                   ///< of kTetrahedronFaces
};

/// Faces of one tetrahedron only, by tetrahedron and face.
std::vector<BoundaryTriangle> boundary_triangles(const TetMesh& mesh);

}  // namespace palpate::geometry
