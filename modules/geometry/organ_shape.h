// The shape of an organ at rest: its surface and, for models of solids, what fills it.
#pragma once

#include <span>

#include "modules/geometry/tet_mesh.h"

namespace palpate::geometry {

/// Nodes are numbered surface first, then inside.
struct OrganShape {
  TriangleSurface surface;
  std::vector<Vec3> inner_nodes;        ///< [m]
  std::vector<Tetrahedron> tetrahedra;  ///< none: a surface
  /// Middle nodes of each tetrahedron's edges, as kTetrahedronEdges; none: linear tetrahedra.
  std::vector<std::array<std::uint32_t, 6>> edge_nodes;

  OrganShape() = default;
  /// A surface, its inside empty.
  OrganShape(TriangleSurface shell)
      : surface(std::move(shell)) {}  // NOLINT: as good as the surface

  bool is_solid() const { return !tetrahedra.empty(); }
  std::size_t node_count() const { return surface.nodes.size() + inner_nodes.size(); }
  const Vec3& node(std::size_t i) const {
    return i < surface.nodes.size() ? surface.nodes[i] : inner_nodes[i - surface.nodes.size()];
  }
};

/// The surfaces' triangles, shape by shape.
std::vector<std::vector<Triangle>> triangles_of(const std::vector<OrganShape>& shapes);

/// Renumbers the mesh: nodes of its boundary first, in their order, then the others in theirs.
/// @throws InputError if its boundary is not one closed manifold surface
OrganShape shape_of(const TetMesh& mesh);
/// The same of a boundary that is known, and known to be sound.
/// @param boundary  as boundary_triangles()
/// @param numbers   out: of the mesh's nodes in the shape
OrganShape shape_of(const TetMesh& mesh, std::span<const BoundaryTriangle> boundary,
                    std::vector<std::uint32_t>& numbers);

/// The same solid of quadratic tetrahedra: straight edges get a node in their middle, each triangle
/// of the surface becomes four. Nodes that there were keep their order.
/// @param shape  solid, linear
OrganShape with_edge_nodes(const OrganShape& shape);

}  // namespace palpate::geometry
