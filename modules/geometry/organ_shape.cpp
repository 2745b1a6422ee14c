#include "modules/geometry/organ_shape.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "modules/core/error.h"
#include "modules/core/sort_unique.h"
#include "modules/geometry/mesh_check.h"

namespace palpate::geometry {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

using Edge = std::array<std::uint32_t, 2>;

Edge edge_between(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// Edges and the number of the first middle node; edge e's is first + e.
class EdgeNumbers {
 public:
  /// @param edges       sorted
  /// @param node_count  of their ends
  EdgeNumbers(std::vector<Edge> edges, std::size_t node_count, std::uint32_t first_number)
      : edges_(std::move(edges)), begins_(node_count + 1, 0), first_number_(first_number) {
    for (const Edge& edge : edges_) ++begins_[edge[0] + 1];
    std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
  }

  const std::vector<Edge>& edges() const { return edges_; }
  std::uint32_t at(std::uint32_t a, std::uint32_t b) const {
    const Edge edge = edge_between(a, b);
    if (edge[1] + 1 >= begins_.size()) return kNone;
    for (std::uint32_t i = begins_[edge[0]]; i < begins_[edge[0] + 1]; ++i) {
      if (edges_[i][1] == edge[1]) return first_number_ + i;
    }
    return kNone;
  }

 private:
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> begins_;  ///< of each first end, in edges_
  std::uint32_t first_number_;
};

std::vector<Edge> edges_inside(const OrganShape& shape, const EdgeNumbers& outside) {
  std::vector<Edge> edges;
  for (const auto& corners : shape.tetrahedra) {
    for (const auto& [i, j] : kTetrahedronEdges) {
      const Edge edge = edge_between(corners[i], corners[j]);
      if (outside.at(edge[0], edge[1]) == kNone) edges.push_back(edge);
    }
  }
  sort_unique(edges);
  return edges;
}

void check_boundary(const TriangleSurface& surface) {
  const MeshReport report = check_surface(surface);
  if (report.holds_volume()) return;
  std::string message = "the boundary of its tetrahedra cannot hold a volume";
  for (const std::string& problem : describe_problems(report, surface)) message += "; " + problem;
  throw InputError(message);
}

}  // namespace

std::vector<std::vector<Triangle>> triangles_of(const std::vector<OrganShape>& shapes) {
  std::vector<std::vector<Triangle>> triangles;
  triangles.reserve(shapes.size());
  for (const auto& shape : shapes) triangles.push_back(shape.surface.triangles);
  return triangles;
}

OrganShape shape_of(const TetMesh& mesh) {
  std::vector<std::uint32_t> numbers;
  OrganShape shape = shape_of(mesh, boundary_triangles(mesh), numbers);
  check_boundary(shape.surface);
  return shape;
}

OrganShape shape_of(const TetMesh& mesh, std::span<const BoundaryTriangle> boundary,
                    std::vector<std::uint32_t>& number) {
  number.assign(mesh.nodes.size(), kNone);
  for (const auto& triangle : boundary) {
    for (const auto node : triangle.nodes) number[node] = 0;
  }
  OrganShape shape;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (number[i] == kNone) continue;
    number[i] = static_cast<std::uint32_t>(shape.surface.nodes.size());
    shape.surface.nodes.push_back(mesh.nodes[i]);
  }
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (number[i] != kNone) continue;
    number[i] = static_cast<std::uint32_t>(shape.node_count());
    shape.inner_nodes.push_back(mesh.nodes[i]);
  }
  for (const auto& triangle : boundary) {
    const auto& [a, b, c] = triangle.nodes;
    shape.surface.triangles.push_back({number[a], number[b], number[c]});
  }
  for (const auto& [a, b, c, d] : mesh.tetrahedra) {
    shape.tetrahedra.push_back({number[a], number[b], number[c], number[d]});
  }
  return shape;
}

OrganShape with_edge_nodes(const OrganShape& shape) {
  PALPATE_DEMAND(shape.is_solid() && shape.edge_nodes.empty());
  const auto corner_count = static_cast<std::uint32_t>(shape.surface.nodes.size());
  const EdgeNumbers outside(edges_of(shape.surface.triangles), corner_count, corner_count);
  const auto surface_count = corner_count + static_cast<std::uint32_t>(outside.edges().size());
  const auto inner_count = static_cast<std::uint32_t>(shape.inner_nodes.size());
  const EdgeNumbers inside(edges_inside(shape, outside), shape.node_count(),
                           surface_count + inner_count);

  OrganShape result;
  result.surface.nodes = shape.surface.nodes;
  for (const auto& [a, b] : outside.edges()) {
    result.surface.nodes.push_back((shape.node(a) + shape.node(b)) / 2);
  }
  result.inner_nodes = shape.inner_nodes;
  for (const auto& [a, b] : inside.edges()) {
    result.inner_nodes.push_back((shape.node(a) + shape.node(b)) / 2);
  }
  for (const auto& [a, b, c] : shape.surface.triangles) {
    const auto ab = outside.at(a, b), bc = outside.at(b, c), ca = outside.at(c, a);
    for (const Triangle& part : {Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
      result.surface.triangles.push_back(part);
    }
  }
  const auto renumbered = [&](std::uint32_t node) {
    return node < corner_count ? node : surface_count + (node - corner_count);
  };
  result.tetrahedra.reserve(shape.tetrahedra.size());
  result.edge_nodes.reserve(shape.tetrahedra.size());
  for (const auto& corners : shape.tetrahedra) {
    auto& middles = result.edge_nodes.emplace_back();
    for (std::size_t e = 0; e < 6; ++e) {
      const auto a = corners[kTetrahedronEdges[e][0]], b = corners[kTetrahedronEdges[e][1]];
      const auto on_surface = outside.at(a, b);
      middles[e] = on_surface != kNone ? on_surface : inside.at(a, b);
    }
    auto& moved = result.tetrahedra.emplace_back(corners);
    for (auto& node : moved) node = renumbered(node);
  }
  return result;
}

}  // namespace palpate::geometry
