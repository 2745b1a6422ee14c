#include "studies/chart/displacement_field.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "modules/geometry/closest_points.h"

namespace palpate::chart {
namespace {

struct SurfacePoint {
  double distance = std::numeric_limits<double>::infinity();
  std::size_t triangle = 0;
  Vec3 weights = Vec3::Zero();
};

SurfacePoint nearest_on_surface(const geometry::TriangleSurface& surface, const Vec3& point) {
  SurfacePoint best;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    const auto closest = geometry::closest_on_triangle(
        point, {surface.nodes[a], surface.nodes[b], surface.nodes[c]});
    const double distance = (closest.point - point).norm();
    if (distance >= best.distance) continue;
    best = {distance, t, closest.weights};
  }
  return best;
}

/// Barycentric coordinates; the smallest says how far outside the point is.
Eigen::Vector4d coordinates_in(const geometry::OrganShape& shape, std::size_t t,
                               const Vec3& point) {
  const auto& [a, b, c, d] = shape.tetrahedra[t];
  Mat3 edges;
  edges << shape.node(b) - shape.node(a), shape.node(c) - shape.node(a),
      shape.node(d) - shape.node(a);
  const Vec3 at = edges.inverse() * (point - shape.node(a));
  return {1 - at.sum(), at.x(), at.y(), at.z()};
}

NodeWeights weights_in_solid(const geometry::OrganShape& shape, const Vec3& point) {
  std::size_t best = 0;
  Eigen::Vector4d at = Eigen::Vector4d::Constant(-std::numeric_limits<double>::infinity());
  for (std::size_t t = 0; t < shape.tetrahedra.size(); ++t) {
    const Eigen::Vector4d here = coordinates_in(shape, t, point);
    if (here.minCoeff() > at.minCoeff()) best = t, at = here;
  }
  NodeWeights weights;
  const bool quadratic = !shape.edge_nodes.empty();
  for (int k = 0; k < 4; ++k) {
    weights.emplace_back(shape.tetrahedra[best][static_cast<std::size_t>(k)],
                         quadratic ? at[k] * (2 * at[k] - 1) : at[k]);
  }
  for (std::size_t e = 0; quadratic && e < 6; ++e) {
    const auto& [i, j] = geometry::kTetrahedronEdges[e];
    weights.emplace_back(shape.edge_nodes[best][e], 4 * at[i] * at[j]);
  }
  return weights;
}

/// Mean value weights of one triangle's corners, seen from the point; zero where the point lies in
/// its plane but outside of it.
Vec3 mean_value(const std::array<Vec3, 3>& arms) {
  std::array<Vec3, 3> u;
  Vec3 distance, theta;
  for (int k = 0; k < 3; ++k) {
    distance[k] = arms[static_cast<std::size_t>(k)].norm();
    u[static_cast<std::size_t>(k)] = arms[static_cast<std::size_t>(k)] / distance[k];
  }
  for (int k = 0; k < 3; ++k) {
    const double chord = (u[(k + 1) % 3] - u[(k + 2) % 3]).norm();
    theta[k] = 2 * std::asin(std::min(1.0, chord / 2));
  }
  const double half = theta.sum() / 2;
  Vec3 cosine, sine, weights = Vec3::Zero();
  const double sign = u[0].dot(u[1].cross(u[2])) < 0 ? -1 : 1;
  for (int k = 0; k < 3; ++k) {
    const double a = theta[(k + 1) % 3], b = theta[(k + 2) % 3];
    cosine[k] = 2 * std::sin(half) * std::sin(half - theta[k]) / (std::sin(a) * std::sin(b)) - 1;
    sine[k] = sign * std::sqrt(std::max(0.0, 1 - cosine[k] * cosine[k]));
    if (std::abs(sine[k]) < 1e-12) return weights;
  }
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    weights[k] = (theta[k] - cosine[a] * theta[b] - cosine[b] * theta[a]) /
                 (distance[k] * std::sin(theta[a]) * sine[b]);
  }
  return weights;
}

NodeWeights weights_in_surface(const geometry::TriangleSurface& surface, const Vec3& point) {
  std::vector<double> sums(surface.nodes.size(), 0);
  double total = 0;
  for (const auto& triangle : surface.triangles) {
    std::array<Vec3, 3> arms;
    for (std::size_t k = 0; k < 3; ++k) arms[k] = surface.nodes[triangle[k]] - point;
    const Vec3 part = mean_value(arms);
    for (std::size_t k = 0; k < 3; ++k) sums[triangle[k]] += part[static_cast<int>(k)];
    total += part.sum();
  }
  NodeWeights weights;
  for (std::uint32_t i = 0; i < sums.size(); ++i) weights.emplace_back(i, sums[i] / total);
  return weights;
}

}  // namespace

NodeWeights weights_at(const geometry::OrganShape& shape, const Vec3& point, double tolerance) {
  const SurfacePoint nearest = nearest_on_surface(shape.surface, point);
  if (nearest.distance <= tolerance) {
    NodeWeights weights;
    for (std::size_t k = 0; k < 3; ++k) {
      weights.emplace_back(shape.surface.triangles[nearest.triangle][k],
                           nearest.weights[static_cast<int>(k)]);
    }
    return weights;
  }
  return shape.is_solid() ? weights_in_solid(shape, point)
                          : weights_in_surface(shape.surface, point);
}

}  // namespace palpate::chart
