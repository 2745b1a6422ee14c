#include "modules/geometry/triangle_surface.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "modules/core/sort_unique.h"

namespace palpate::geometry {
namespace {

// All sums are taken about the first node: far from the origin, products of absolute positions
// would cancel to nothing.
Vec3 reference_point(std::span<const Vec3> nodes) {
  return nodes.empty() ? Vec3::Zero() : nodes[0];
}

}  // namespace

double enclosed_volume(std::span<const Vec3> nodes, std::span<const Triangle> triangles) {
  const Vec3 origin = reference_point(nodes);
  double six_volumes = 0;
  for (const auto& [a, b, c] : triangles) {
    six_volumes += (nodes[a] - origin).dot((nodes[b] - origin).cross(nodes[c] - origin));
  }
  return six_volumes / 6;
}

double surface_area(std::span<const Vec3> nodes, std::span<const Triangle> triangles) {
  double area = 0;
  for (const Triangle& triangle : triangles) area += area_vector(nodes, triangle).norm();
  return area;
}

Vec3 area_vector(std::span<const Vec3> nodes, const Triangle& triangle) {
  const Vec3& a = nodes[triangle[0]];
  return 0.5 * (nodes[triangle[1]] - a).cross(nodes[triangle[2]] - a);
}

// V = ∮ x n_x dA = ∮ y n_y dA = ∮ z n_z dA; on a flat triangle the integral is the mean of the
// corners times the area vector's component.
std::array<double, 3> three_axis_volumes(std::span<const Vec3> nodes,
                                         std::span<const Triangle> triangles) {
  const Vec3 origin = reference_point(nodes);
  Vec3 volumes = Vec3::Zero();
  for (const Triangle& triangle : triangles) {
    const Vec3 middle = (nodes[triangle[0]] + nodes[triangle[1]] + nodes[triangle[2]]) / 3 - origin;
    volumes += middle.cwiseProduct(area_vector(nodes, triangle));
  }
  return {volumes.x(), volumes.y(), volumes.z()};
}

// Sum over the tetrahedra (origin, a, b, c): volume times the mean of its four corners.
Vec3 solid_centroid(const TriangleSurface& surface) {
  const Vec3 origin = reference_point(surface.nodes);
  double six_volumes = 0;
  Vec3 moment = Vec3::Zero();
  for (const auto& [a, b, c] : surface.triangles) {
    const Vec3 x_a = surface.nodes[a] - origin, x_b = surface.nodes[b] - origin,
               x_c = surface.nodes[c] - origin;
    const double six_volume = x_a.dot(x_b.cross(x_c));
    six_volumes += six_volume;
    moment += six_volume * (x_a + x_b + x_c) / 4;
  }
  return six_volumes == 0 ? origin : Vec3(origin + moment / six_volumes);
}

Vec3 dominant_axis(std::span<const Vec3> nodes) {
  if (nodes.empty()) return Vec3::UnitX();
  Vec3 mean = Vec3::Zero();
  for (const Vec3& node : nodes) mean += (node - nodes[0]) / static_cast<double>(nodes.size());
  mean += nodes[0];
  Mat3 covariance = Mat3::Zero();
  for (const Vec3& node : nodes) covariance += (node - mean) * (node - mean).transpose();
  Vec3 axis = Eigen::SelfAdjointEigenSolver<Mat3>(covariance).eigenvectors().col(2);
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0 ? Vec3(-axis) : axis;
}

std::vector<std::array<std::uint32_t, 2>> edges_of(std::span<const Triangle> triangles) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& triangle : triangles) {
    for (int i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax(triangle[i], triangle[(i + 1) % 3]);
      if (a != b) edges.push_back({a, b});
    }
  }
  sort_unique(edges);
  return edges;
}

double mean_edge_length(const TriangleSurface& surface) {
  const auto edges = edges_of(surface.triangles);
  double sum = 0;
  for (const auto& [a, b] : edges) sum += (surface.nodes[a] - surface.nodes[b]).norm();
  return sum / static_cast<double>(edges.size());
}

}  // namespace palpate::geometry
