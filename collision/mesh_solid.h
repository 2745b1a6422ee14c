// A closed triangle mesh as a solid probe, and the features of a solid with sharp edges.
#pragma once

#include <array>
#include <span>

#include "collision/bounds.h"
#include "collision/probe_solid.h"
#include "modules/geometry/aabb_tree.h"

namespace palpate::collision {

struct SharpEdge {
  std::array<std::uint32_t, 2> vertices{};
  std::array<Vec3, 2> face_normals;  ///< unit, outward, of the faces it joins
  std::array<Vec3, 2> into_face;     ///< unit, in each face, away from the edge
};

/// Vertices, edges and faces of a solid.
class SharpMesh {
 public:
  /// @param mesh  closed, outward; degenerate triangles take no part
  explicit SharpMesh(geometry::TriangleSurface mesh);

  const std::vector<Vec3>& vertices() const { return mesh_.nodes; }
  const std::vector<geometry::Triangle>& triangles() const { return mesh_.triangles; }
  /// Edges whose faces differ in direction; flat ones cannot touch before their faces do.
  const std::vector<SharpEdge>& edges() const { return edges_; }
  Bounds bounds() const;

  /// Vertices in a box and sharp edges whose bounds overlap it, ascending.
  void features_near(const Bounds& box, std::vector<std::uint32_t>& vertices,
                     std::vector<std::uint32_t>& edges) const;
  void triangles_near(const Bounds& box, std::vector<std::uint32_t>& triangles) const;

  /// Unit normal of a face; zero if degenerate.
  const Vec3& face_normal(std::uint32_t triangle) const { return face_normals_[triangle]; }
  /// Angle-weighted normal of the feature of `triangle` at `weights`, whose sign tells inside from
  /// outside (Bærentzen and Aanæs 2005). Not unit.
  Vec3 pseudonormal(std::uint32_t triangle, const Vec3& weights) const;

 private:
  void build_normals();
  void build_edges();

  geometry::TriangleSurface mesh_;
  std::vector<Vec3> face_normals_, vertex_normals_;
  std::vector<std::array<Vec3, 3>> edge_normals_;  ///< per triangle, of edge k → k+1
  std::vector<SharpEdge> edges_;
  std::vector<Bounds> edge_bounds_;
  std::vector<std::array<std::uint32_t, 3>> edges_of_triangle_;  ///< index or kFlatEdge
  geometry::AabbTree tree_;
};

/// @param mesh  outlives the solid
std::unique_ptr<ProbeSolid> make_mesh_solid(const SharpMesh& mesh);

}  // namespace palpate::collision
