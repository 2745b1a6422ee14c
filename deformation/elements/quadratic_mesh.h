// Ten-node tetrahedra: corners and one node per edge.
#pragma once

#include "modules/geometry/tet_mesh.h"

namespace palpate::deformation {

inline constexpr int kElementNodes = 10;
inline constexpr int kFaceNodes = 6;

using geometry::kTetrahedronEdges;
using geometry::Tetrahedron;

struct BoundaryFace {
  std::array<int, kFaceNodes> local{};  ///< corners, then nodes of edges 01, 12, 20, in the element
  std::uint32_t element = 0;
};

struct QuadraticMesh {
  std::vector<Vec3> nodes;       ///< rest positions [m]
  std::size_t corner_count = 0;  ///< corners carry the pressure
  std::vector<std::array<std::uint32_t, kElementNodes>> elements;
  std::vector<Tetrahedron> corners;  ///< of each element, as numbered among all corners
  std::vector<BoundaryFace> faces;   ///< outward

  std::uint32_t face_node(const BoundaryFace& face, int k) const {
    return elements[face.element][face.local[k]];
  }
};

/// Adds the edges' middles; edges are straight. Corners come first and keep their indices.
/// @param mesh  every node in some tetrahedron
QuadraticMesh make_quadratic(const geometry::TetMesh& mesh);

/// From nodes in any order, each in some tetrahedron. Faces are not looked for.
/// @param middles  of the tetrahedra's edges, as kTetrahedronEdges
QuadraticMesh make_quadratic(std::vector<Vec3> nodes, const std::vector<Tetrahedron>& tetrahedra,
                             const std::vector<std::array<std::uint32_t, 6>>& middles);

/// Curves what was meshed from a sphere: edge nodes of boundary faces with all three corners on it,
/// within 1e-6 of the radius, move radially onto it. The elements become isoparametric there.
void curve_onto_sphere(QuadraticMesh& mesh, const Vec3& centre, double radius);

}  // namespace palpate::deformation
