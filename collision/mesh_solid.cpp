#include "collision/mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "modules/core/sort_unique.h"
#include "modules/core/tolerances.h"
#include "modules/geometry/closest_points.h"
#include "modules/geometry/continuous_collision.h"

namespace palpate::collision {
namespace {

constexpr double kFlat = 0.9999;  // cosine between faces: below 0.8°

geometry::TriangleCorners corners_of(const geometry::TriangleSurface& mesh,
                                     std::uint32_t triangle) {
  const geometry::Triangle& t = mesh.triangles[triangle];
  return {mesh.nodes[t[0]], mesh.nodes[t[1]], mesh.nodes[t[2]]};
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Unit, in the plane of `normal`, perpendicular to a–b, towards `inner`.
Vec3 into_face(const Vec3& a, const Vec3& b, const Vec3& inner, const Vec3& normal) {
  const Vec3 across = normal.cross(b - a).normalized();
  return across.dot(inner - a) < 0 ? Vec3(-across) : across;
}

/// One that holds those of all these edges.
NormalCone cone_of(std::span<const std::uint32_t> edges, const std::vector<NormalCone>& cones) {
  Vec3 axis = Vec3::Zero();
  for (const std::uint32_t edge : edges) {
    if (!cones[edge].is_empty()) axis += cones[edge].axis();
  }
  if (axis.norm() < 1e-6) axis = Vec3::UnitZ();
  axis.normalize();
  double angle = -1;
  for (const std::uint32_t edge : edges) {
    if (cones[edge].is_empty()) continue;
    angle = std::max(angle, angle_between(axis, cones[edge].axis()) + cones[edge].angle() + 1e-9);
  }
  return {axis, std::min(angle, std::numbers::pi)};
}

/// A segment and what is beside it, against boxes. Ericson, Real-Time Collision Detection, §5.3.3.
class WideSegment {
 public:
  WideSegment(const Vec3& a, const Vec3& b, double beside)
      : middle_((a + b) / 2), half_((b - a) / 2), beside_(beside + kDirectionless) {}

  /// False only if nothing of the box is so near.
  bool meets(const geometry::BoxTree::Box& box) const {
    const Vec3 apart = box.center() - middle_;
    const Vec3 size = box.sizes() / 2 + Vec3::Constant(beside_), along = half_.cwiseAbs();
    if ((apart.cwiseAbs() - size - along).maxCoeff() > 0) return false;
    const Vec3 across = half_.cross(apart).cwiseAbs();
    return across[0] <= size[1] * along[2] + size[2] * along[1] &&
           across[1] <= size[0] * along[2] + size[2] * along[0] &&
           across[2] <= size[0] * along[1] + size[1] * along[0];
  }

 private:
  Vec3 middle_, half_;
  double beside_;
};

class MeshSolid final : public ProbeSolid {
 public:
  explicit MeshSolid(const SharpMesh& mesh) : mesh_(mesh), bounds_(mesh.bounds()) {}

  std::optional<SolidPoint> nearest(const Vec3& x, double within) const override {
    constexpr double kAbove = 1 + 1e-12;  // its square is not below another's for rounding
    double least = within;
    std::uint32_t nearest = 0;
    std::optional<geometry::PointOnTriangle> closest;
    mesh_.visit_near(
        x, [&] { return kAbove * least * least; },
        [&](std::uint32_t t) {
          if (mesh_.face_normal(t) == Vec3::Zero()) return;
          const geometry::PointOnTriangle at = geometry::closest_on_triangle(x, corners(t));
          const double distance = (x - at.point).norm();
          if (distance > least || (closest && distance == least && t > nearest)) return;
          least = distance;
          nearest = t;
          closest = at;
        });
    if (!closest) return {};
    const Vec3 apart = x - closest->point;
    const double sign = mesh_.pseudonormal(nearest, closest->weights).dot(apart) < 0 ? -1 : 1;
    SolidPoint found{closest->point, mesh_.face_normal(nearest), sign * least, false};
    if (least > kDirectionless) found.outward = sign * apart / least;
    return found;
  }

  std::optional<SolidEntry> entry(const Vec3& start, const Vec3& end,
                                  double separation) const override {
    std::vector<std::uint32_t> near;
    mesh_.append_triangles_along(start, end, separation + geometry::kImpactTolerance, near);
    std::sort(near.begin(), near.end());
    std::optional<SolidEntry> first;
    for (const std::uint32_t t : near) {
      const Vec3& normal = mesh_.face_normal(t);
      const geometry::TriangleCorners c = corners(t);
      if (normal.dot(start - c[0]) <= 0 || normal.dot(end - start) >= 0) continue;
      const auto impact = geometry::point_triangle_impact({start, c[0], c[1], c[2]},
                                                          {end, c[0], c[1], c[2]}, separation);
      if (!impact || (first && first->time <= impact->time)) continue;
      first = SolidEntry{impact->time, start + impact->time * (end - start), normal};
    }
    return first;
  }

  bool shadows(const Vec3& x, const Vec3& direction) const override {
    const double length = (bounds_.upper - bounds_.lower).norm() + bounds_.lower.norm() + x.norm();
    const Vec3 end = x + length * direction;
    std::vector<std::uint32_t> near;
    mesh_.append_triangles_along(x, end, geometry::kImpactTolerance, near);
    return std::any_of(near.begin(), near.end(), [&](std::uint32_t t) {
      return mesh_.face_normal(t) != Vec3::Zero() &&
             geometry::closest_of_segment_and_triangle(x, end, corners(t)).distance <
                 geometry::kImpactTolerance;
    });
  }

 private:
  geometry::TriangleCorners corners(std::uint32_t t) const {
    const geometry::Triangle& nodes = mesh_.triangles()[t];
    return {mesh_.vertices()[nodes[0]], mesh_.vertices()[nodes[1]], mesh_.vertices()[nodes[2]]};
  }

  const SharpMesh& mesh_;
  Bounds bounds_;
};

}  // namespace

SharpMesh::SharpMesh(geometry::TriangleSurface mesh)
    : mesh_(std::move(mesh)), tree_(mesh_), vertex_tree_({}), edge_tree_({}) {
  build_normals();
  build_edges();
  build_trees();
}

void SharpMesh::build_normals() {
  vertex_normals_.assign(mesh_.nodes.size(), Vec3::Zero());
  for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
    const geometry::TriangleCorners c = corners_of(mesh_, t);
    face_normals_.push_back(geometry::unit_normal(c));
    for (int k = 0; k < 3; ++k) {
      const double angle = angle_between(c[(k + 1) % 3] - c[k], c[(k + 2) % 3] - c[k]);
      vertex_normals_[mesh_.triangles[t][k]] += angle * face_normals_.back();
    }
  }
}

void SharpMesh::build_edges() {
  struct Side {
    std::uint32_t triangle;
    int corner;
  };
  std::map<std::array<std::uint32_t, 2>, std::vector<Side>> sides;
  for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]);
      if (face_normals_[t] != Vec3::Zero()) sides[{a, b}].push_back({t, k});
    }
  }
  edge_normals_.resize(mesh_.triangles.size());
  for (const auto& [vertices, around] : sides) {
    const Side &one = around.front(), &other = around.back();
    SharpEdge edge{vertices, {face_normals_[one.triangle], face_normals_[other.triangle]}, {}};
    const bool is_flat =
        around.size() == 2 && edge.face_normals[0].dot(edge.face_normals[1]) > kFlat;
    for (const Side& side : around) {
      edge_normals_[side.triangle][side.corner] = edge.face_normals[0] + edge.face_normals[1];
    }
    if (is_flat) continue;
    const Vec3 &a = mesh_.nodes[vertices[0]], &b = mesh_.nodes[vertices[1]];
    for (int k = 0; k < 2; ++k) {
      const Side& side = k == 0 ? one : other;
      const Vec3& inner = mesh_.nodes[mesh_.triangles[side.triangle][(side.corner + 2) % 3]];
      edge.into_face[k] = into_face(a, b, inner, edge.face_normals[k]);
    }
    edges_.push_back(edge);
    edge_cones_.push_back(around.size() == 2 ? cone_of_edge(edge.face_normals[0],
                                                            edge.face_normals[1], edge.into_face[1])
                                             : NormalCone{});
  }
}

void SharpMesh::build_trees() {
  for (const geometry::Triangle& t : mesh_.triangles) {
    vertices_.insert(vertices_.end(), t.begin(), t.end());
  }
  sort_unique(vertices_);
  std::vector<geometry::BoxTree::Box> of_vertices, of_edges;
  for (const std::uint32_t vertex : vertices_) of_vertices.emplace_back(mesh_.nodes[vertex]);
  for (const SharpEdge& edge : edges_) {
    of_edges.emplace_back(mesh_.nodes[edge.vertices[0]]);
    of_edges.back().extend(mesh_.nodes[edge.vertices[1]]);
  }
  vertex_tree_ = geometry::BoxTree(std::move(of_vertices));
  edge_tree_ = geometry::BoxTree(std::move(of_edges));
  for (const auto& branch : edge_tree_.branches()) {
    branch_cones_.push_back(cone_of(edge_tree_.items_of(branch), edge_cones_));
  }
}

Bounds SharpMesh::bounds() const {
  Bounds box;
  for (const Vec3& x : mesh_.nodes) box.add(x);
  return box;
}

void SharpMesh::append_vertices(const Bounds& box, std::vector<std::uint32_t>& vertices) const {
  const std::size_t first = vertices.size();
  vertex_tree_.append_overlapping({box.lower, box.upper}, vertices);
  for (std::size_t i = first; i < vertices.size(); ++i) vertices[i] = vertices_[vertices[i]];
}

void SharpMesh::append_nearest_vertices(const geometry::TriangleCorners& to, double within,
                                        std::size_t count,
                                        std::vector<std::uint32_t>& vertices) const {
  geometry::BoxTree::Box box(to[0]);
  box.extend(to[1]).extend(to[2]);
  std::vector<std::pair<double, std::uint32_t>> nearest;  // a heap, the furthest on top
  vertex_tree_.visit_near(
      [&](const geometry::BoxTree::Box& of) { return box.squaredExteriorDistance(of); },
      [&] { return nearest.size() < count ? within * within : nearest.front().first; },
      [&](std::uint32_t item) {
        const std::uint32_t vertex = vertices_[item];
        const Vec3& x = mesh_.nodes[vertex];
        const double squared = (x - geometry::closest_on_triangle(x, to).point).squaredNorm();
        if (squared > within * within) return;
        nearest.push_back({squared, vertex});
        std::ranges::push_heap(nearest);
        if (nearest.size() <= count) return;
        std::ranges::pop_heap(nearest);
        nearest.pop_back();
      });
  for (const auto& [squared, vertex] : nearest) vertices.push_back(vertex);
}

void SharpMesh::append_edges(const Bounds& box, const Bounds& wider, const NormalCone& from,
                             std::vector<std::uint32_t>& edges) const {
  const geometry::BoxTree::Box near(box.lower, box.upper), far(wider.lower, wider.upper);
  const auto may_touch = [&](const geometry::BoxTree::Box& of, const NormalCone& cone) {
    return of.intersects(near) || (of.intersects(far) && cone.may_oppose(from));
  };
  edge_tree_.visit(
      [&](std::uint32_t branch) {
        return may_touch(edge_tree_.branches()[branch].box, branch_cones_[branch]);
      },
      [&](std::uint32_t edge) {
        if (may_touch(edge_tree_.boxes()[edge], edge_cones_[edge])) edges.push_back(edge);
      });
}

void SharpMesh::append_triangles_along(const Vec3& a, const Vec3& b, double within,
                                       std::vector<std::uint32_t>& triangles) const {
  const WideSegment way(a, b, within);
  const geometry::BoxTree& tree = tree_.boxes();
  tree.visit([&](std::uint32_t branch) { return way.meets(tree.branches()[branch].box); },
             [&](std::uint32_t triangle) {
               if (way.meets(tree.boxes()[triangle])) triangles.push_back(triangle);
             });
}

Vec3 SharpMesh::pseudonormal(std::uint32_t triangle, const Vec3& weights) const {
  const auto& nodes = mesh_.triangles[triangle];
  const auto zeros = (weights.array() == 0).count();
  if (zeros == 2) {
    for (int k = 0; k < 3; ++k) {
      if (weights[k] > 0) return vertex_normals_[nodes[k]];
    }
  }
  if (zeros == 1) {
    for (int k = 0; k < 3; ++k) {
      if (weights[k] == 0) return edge_normals_[triangle][(k + 1) % 3];
    }
  }
  return face_normals_[triangle];
}

std::unique_ptr<ProbeSolid> make_mesh_solid(const SharpMesh& mesh) {
  return std::make_unique<MeshSolid>(mesh);
}

}  // namespace palpate::collision
