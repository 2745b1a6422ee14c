#include "deformation/elements/quadratic_mesh.h"

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"
#include "modules/core/sort_unique.h"

namespace palpate::deformation {
namespace {

using Edge = std::array<std::uint32_t, 2>;

Edge edge_of(const Tetrahedron& corners, int edge) {
  const auto [a, b] =
      std::minmax(corners[kTetrahedronEdges[edge][0]], corners[kTetrahedronEdges[edge][1]]);
  return {a, b};
}

int local_edge_node(int a, int b) {
  for (int e = 0; e < 6; ++e) {
    const auto& [c, d] = kTetrahedronEdges[e];
    if ((a == c && b == d) || (a == d && b == c)) return 4 + e;
  }
  return -1;
}

std::array<int, kFaceNodes> face_locals(int face) {
  const auto& [a, b, c] = geometry::kTetrahedronFaces[face];
  return {a, b, c, local_edge_node(a, b), local_edge_node(b, c), local_edge_node(c, a)};
}

}  // namespace

QuadraticMesh make_quadratic(const geometry::TetMesh& mesh) {
  QuadraticMesh result;
  result.nodes = mesh.nodes;
  result.corner_count = mesh.nodes.size();
  std::vector<Edge> edges;
  edges.reserve(6 * mesh.tetrahedra.size());
  for (const auto& corners : mesh.tetrahedra) {
    for (int e = 0; e < 6; ++e) edges.push_back(edge_of(corners, e));
  }
  sort_unique(edges);
  for (const auto& [a, b] : edges) result.nodes.push_back((mesh.nodes[a] + mesh.nodes[b]) / 2);
  for (const auto& corners : mesh.tetrahedra) {
    auto& element = result.elements.emplace_back();
    std::copy(corners.begin(), corners.end(), element.begin());
    result.corners.push_back(corners);
    for (int e = 0; e < 6; ++e) {
      const auto at = std::lower_bound(edges.begin(), edges.end(), edge_of(corners, e));
      element[4 + e] = static_cast<std::uint32_t>(mesh.nodes.size() + (at - edges.begin()));
    }
  }
  for (const auto& triangle : geometry::boundary_triangles(mesh)) {
    result.faces.push_back({face_locals(triangle.face), triangle.tetrahedron});
  }
  return result;
}

QuadraticMesh make_quadratic(std::vector<Vec3> nodes, const std::vector<Tetrahedron>& tetrahedra,
                             const std::vector<std::array<std::uint32_t, 6>>& middles) {
  PALPATE_DEMAND(tetrahedra.size() == middles.size());
  QuadraticMesh result;
  std::vector<std::uint32_t> numbers(nodes.size(), 0);
  for (const auto& corners : tetrahedra) {
    for (const auto node : corners) numbers.at(node) = 1;
  }
  for (auto& number : numbers) {
    if (number == 1) number = static_cast<std::uint32_t>(result.corner_count++);
  }
  result.nodes = std::move(nodes);
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    auto& element = result.elements.emplace_back();
    const auto middle = std::copy(tetrahedra[e].begin(), tetrahedra[e].end(), element.begin());
    std::copy(middles[e].begin(), middles[e].end(), middle);
    auto& corners = result.corners.emplace_back();
    for (std::size_t m = 0; m < 4; ++m) corners[m] = numbers[tetrahedra[e][m]];
  }
  return result;
}

void curve_onto_sphere(QuadraticMesh& mesh, const Vec3& centre, double radius) {
  const auto on_sphere = [&](std::uint32_t node) {
    return std::abs((mesh.nodes[node] - centre).norm() - radius) < 1e-6 * radius;
  };
  std::vector<std::uint32_t> moved;
  for (const auto& face : mesh.faces) {
    if (!on_sphere(mesh.face_node(face, 0)) || !on_sphere(mesh.face_node(face, 1)) ||
        !on_sphere(mesh.face_node(face, 2))) {
      continue;
    }
    for (int k = 3; k < kFaceNodes; ++k) moved.push_back(mesh.face_node(face, k));
  }
  for (const auto node : moved) {
    const Vec3 arm = mesh.nodes[node] - centre;
    mesh.nodes[node] = centre + radius / arm.norm() * arm;
  }
}

}  // namespace palpate::deformation
