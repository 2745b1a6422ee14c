#include "collision/mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "modules/core/sort_unique.h"
#include "modules/core/tolerances.h"
#include "modules/geometry/closest_points.h"
#include "modules/geometry/continuous_collision.h"

namespace palpate::collision {
namespace {

constexpr std::uint32_t kFlatEdge = 0xffffffff;
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

class MeshSolid final : public ProbeSolid {
 public:
  explicit MeshSolid(const SharpMesh& mesh) : mesh_(mesh), bounds_(mesh.bounds()) {}

  std::optional<SolidPoint> nearest(const Vec3& x, double within) const override {
    Bounds box{x, x};
    box.inflate(within);
    std::vector<std::uint32_t> near;
    mesh_.triangles_near(box, near);
    std::optional<SolidPoint> best;
    for (const std::uint32_t t : near) {
      if (mesh_.face_normal(t) == Vec3::Zero()) continue;
      const geometry::PointOnTriangle closest = geometry::closest_on_triangle(x, corners(t));
      const double distance = (x - closest.point).norm();
      if (distance > (best ? std::abs(best->distance) : within)) continue;
      if (best && distance == std::abs(best->distance)) continue;
      const Vec3 normal = mesh_.pseudonormal(t, closest.weights);
      const double sign = normal.dot(x - closest.point) < 0 ? -1 : 1;
      best = SolidPoint{closest.point, mesh_.face_normal(t), sign * distance, false};
      if (distance > kDirectionless) best->outward = sign * (x - closest.point) / distance;
    }
    return best;
  }

  std::optional<SolidEntry> entry(const Vec3& start, const Vec3& end,
                                  double separation) const override {
    Bounds box{start, start};
    box.add(end);
    box.inflate(separation + geometry::kImpactTolerance);
    std::vector<std::uint32_t> near;
    mesh_.triangles_near(box, near);
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
    Bounds box{x, x};
    box.add(end);
    std::vector<std::uint32_t> near;
    mesh_.triangles_near(box, near);
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

SharpMesh::SharpMesh(geometry::TriangleSurface mesh) : mesh_(std::move(mesh)), tree_(mesh_) {
  build_normals();
  build_edges();
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
  edges_of_triangle_.assign(mesh_.triangles.size(), {kFlatEdge, kFlatEdge, kFlatEdge});
  for (const auto& [vertices, around] : sides) {
    const Side &one = around.front(), &other = around.back();
    SharpEdge edge{vertices, {face_normals_[one.triangle], face_normals_[other.triangle]}, {}};
    const bool is_flat =
        around.size() == 2 && edge.face_normals[0].dot(edge.face_normals[1]) > kFlat;
    for (const Side& side : around) {
      edge_normals_[side.triangle][side.corner] = edge.face_normals[0] + edge.face_normals[1];
      if (!is_flat)
        edges_of_triangle_[side.triangle][side.corner] = static_cast<std::uint32_t>(edges_.size());
    }
    if (is_flat) continue;
    const Vec3 &a = mesh_.nodes[vertices[0]], &b = mesh_.nodes[vertices[1]];
    for (int k = 0; k < 2; ++k) {
      const Side& side = k == 0 ? one : other;
      const Vec3& inner = mesh_.nodes[mesh_.triangles[side.triangle][(side.corner + 2) % 3]];
      edge.into_face[k] = into_face(a, b, inner, edge.face_normals[k]);
    }
    edges_.push_back(edge);
    edge_bounds_.push_back({a.cwiseMin(b), a.cwiseMax(b)});
  }
}

Bounds SharpMesh::bounds() const {
  Bounds box;
  for (const Vec3& x : mesh_.nodes) box.add(x);
  return box;
}

void SharpMesh::features_near(const Bounds& box, std::vector<std::uint32_t>& vertices,
                              std::vector<std::uint32_t>& edges) const {
  std::vector<std::uint32_t> near;
  tree_.append_overlapping({box.lower, box.upper}, near);
  vertices.clear();
  edges.clear();
  for (const std::uint32_t t : near) {
    const auto& nodes = mesh_.triangles[t];
    for (const std::uint32_t vertex : nodes) {
      const Vec3& x = mesh_.nodes[vertex];
      if (box.overlaps({x, x})) vertices.push_back(vertex);
    }
    for (const std::uint32_t edge : edges_of_triangle_[t]) {
      if (edge != kFlatEdge && box.overlaps(edge_bounds_[edge])) edges.push_back(edge);
    }
  }
  sort_unique(vertices);
  sort_unique(edges);
}

void SharpMesh::triangles_near(const Bounds& box, std::vector<std::uint32_t>& triangles) const {
  tree_.append_overlapping({box.lower, box.upper}, triangles);
  std::sort(triangles.begin(), triangles.end());
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
