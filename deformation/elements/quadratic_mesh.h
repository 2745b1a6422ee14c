// Ten-node tetrahedra: corners and one node per edge.
#pragma once

#include "deformation/elements/tet_mesh.h"

namespace palpate::elements {

inline constexpr int kElementNodes = 10;
inline constexpr int kFaceNodes = 6;

/// Corners of the edges whose nodes follow the four corners, in this order.
inline constexpr std::array<std::array<int, 2>, 6> kTetrahedronEdges{
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

struct BoundaryFace {
  std::array<int, kFaceNodes> local{};  ///< corners, then nodes of edges 01, 12, 20, in the element
  std::uint32_t element = 0;
};

struct QuadraticMesh {
  std::vector<Vec3> nodes;       ///< rest positions, corners first [m]
  std::size_t corner_count = 0;  ///< corners carry the pressure
  std::vector<std::array<std::uint32_t, kElementNodes>> elements;
  std::vector<BoundaryFace> faces;  ///< outward

  std::uint32_t face_node(const BoundaryFace& face, int k) const {
    return elements[face.element][face.local[k]];
  }
};

/// Adds the edges' middles; edges are straight. Corners keep their indices.
/// @param mesh  every node in some tetrahedron
QuadraticMesh make_quadratic(const TetMesh& mesh);

/// Curves what was meshed from a sphere: edge nodes of boundary faces with all three corners on it,
/// within 1e-6 of the radius, move radially onto it. The elements become isoparametric there.
void curve_onto_sphere(QuadraticMesh& mesh, const Vec3& centre, double radius);

}  // namespace palpate::elements
