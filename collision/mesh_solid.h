// A closed triangle mesh as a solid probe, and the features of a solid with sharp edges.
#pragma once

#include <array>
#include <span>

#include "collision/bounds.h"
#include "collision/normal_cone.h"
#include "collision/probe_solid.h"
#include "modules/geometry/aabb_tree.h"
#include "modules/geometry/closest_points.h"

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

  /// Appends the vertices of triangles that are in a box, in no useful order.
  void append_vertices(const Bounds& box, std::vector<std::uint32_t>& vertices) const;
  /// Appends the sharp edges whose bounds overlap a box; and of those that overlap a wider one the
  /// edges that may be touched from the directions of a cone. In no useful order.
  void append_edges(const Bounds& box, const Bounds& wider, const NormalCone& from,
                    std::vector<std::uint32_t>& edges) const;
  /// Appends the triangles whose boxes come within a distance of a segment, in no useful order.
  void append_triangles_along(const Vec3& a, const Vec3& b, double within,
                              std::vector<std::uint32_t>& triangles) const;

  /// Appends so many vertices of triangles, the nearest to a triangle of those within a distance,
  /// in no useful order.
  void append_nearest_vertices(const geometry::TriangleCorners& to, double within,
                               std::size_t count, std::vector<std::uint32_t>& vertices) const;
  /// Calls visit(triangle) for all that may be within a distance of a point
  /// (BoxTree::visit_near()).
  template <class Limit, class Visit>
  void visit_near(const Vec3& point, const Limit& squared_limit, const Visit& visit) const {
    tree_.boxes().visit_near(
        [&](const geometry::BoxTree::Box& box) { return box.squaredExteriorDistance(point); },
        squared_limit, visit);
  }

  /// Unit normal of a face; zero if degenerate.
  const Vec3& face_normal(std::uint32_t triangle) const { return face_normals_[triangle]; }
  /// Angle-weighted normal of the feature of `triangle` at `weights`, whose sign tells inside from
  /// outside (Bærentzen and Aanæs 2005). Not unit.
  Vec3 pseudonormal(std::uint32_t triangle, const Vec3& weights) const;

 private:
  void build_normals();
  void build_edges();
  void build_trees();

  geometry::TriangleSurface mesh_;
  std::vector<Vec3> face_normals_, vertex_normals_;
  std::vector<std::array<Vec3, 3>> edge_normals_;  ///< per triangle, of edge k → k+1
  std::vector<SharpEdge> edges_;
  geometry::AabbTree tree_;
  std::vector<std::uint32_t> vertices_;                ///< of triangles
  std::vector<NormalCone> edge_cones_, branch_cones_;  ///< by edge, by branch of edge_tree_
  geometry::BoxTree vertex_tree_, edge_tree_;          ///< of vertices_ and edges_
};

/// @param mesh  outlives the solid
std::unique_ptr<ProbeSolid> make_mesh_solid(const SharpMesh& mesh);

}  // namespace palpate::collision
