#include "visualizer/shape_measures.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace palpate::visualizer {
namespace {

using Vec3f = Eigen::Vector3f;

Vec3f node(std::span<const float> xyz, std::uint32_t i) {
  return {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]};
}

Vec3f area_vector(std::span<const float> xyz, const TriangleIndices& t) {
  const Vec3f a = node(xyz, t[0]);
  return 0.5f * (node(xyz, t[1]) - a).cross(node(xyz, t[2]) - a);
}

float strain_of(std::span<const float> rest, std::span<const float> now, const TriangleIndices& t) {
  const Vec3f a0 = node(rest, t[1]) - node(rest, t[0]), b0 = node(rest, t[2]) - node(rest, t[0]);
  const Vec3f a = node(now, t[1]) - node(now, t[0]), b = node(now, t[2]) - node(now, t[0]);
  // Rest edges in an orthonormal frame of the plane: a₀ = (p, 0), b₀ = (q, r).
  const double p = a0.norm();
  const double q = p > 0 ? a0.dot(b0) / p : 0.0;
  const double r = p > 0 ? a0.cross(b0).norm() / p : 0.0;
  if (!(r > 1e-6 * p)) return 0;
  // Columns of D D₀⁻¹: a/p and (b − a q/p)/r.
  const Eigen::Vector3d u = a.cast<double>() / p;
  const Eigen::Vector3d v = (b.cast<double>() - q * u) / r;
  const double mean = 0.5 * (u.squaredNorm() + v.squaredNorm());
  const double half_difference = 0.5 * (u.squaredNorm() - v.squaredNorm()), shear = u.dot(v);
  const double spread = std::sqrt(half_difference * half_difference + shear * shear);
  const double largest = std::sqrt(mean + spread);
  const double smallest = std::sqrt(std::max(0.0, mean - spread));
  return static_cast<float>(std::max(std::abs(largest - 1), std::abs(smallest - 1)));
}

}  // namespace

void node_normals(std::span<const float> positions, std::span<const TriangleIndices> triangles,
                  std::vector<float>& normals) {
  normals.assign(positions.size(), 0.0f);
  for (const TriangleIndices& t : triangles) {
    const Vec3f area = area_vector(positions, t);
    for (const std::uint32_t i : t) {
      for (int c = 0; c < 3; ++c) normals[3 * i + c] += area[c];
    }
  }
  for (std::size_t i = 0; i + 2 < normals.size(); i += 3) {
    const float length = node(normals, static_cast<std::uint32_t>(i / 3)).norm();
    if (length > 0) {
      for (int c = 0; c < 3; ++c) normals[i + c] /= length;
    }
  }
}

void node_displacements(std::span<const float> rest, std::span<const float> positions,
                        std::vector<float>& displacements) {
  displacements.resize(rest.size() / 3);
  for (std::uint32_t i = 0; i < displacements.size(); ++i) {
    displacements[i] = (node(positions, i) - node(rest, i)).norm();
  }
}

void triangle_strains(std::span<const float> rest, std::span<const float> positions,
                      std::span<const TriangleIndices> triangles, std::vector<float>& strains) {
  strains.resize(triangles.size());
  std::transform(triangles.begin(), triangles.end(), strains.begin(),
                 [&](const TriangleIndices& t) { return strain_of(rest, positions, t); });
}

void average_to_nodes(std::span<const float> rest, std::span<const TriangleIndices> triangles,
                      std::span<const float> triangle_values, std::vector<float>& node_values) {
  node_values.assign(rest.size() / 3, 0.0f);
  std::vector<float> weights(node_values.size(), 0.0f);
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const float area = area_vector(rest, triangles[k]).norm();
    for (const std::uint32_t i : triangles[k]) {
      node_values[i] += area * triangle_values[k];
      weights[i] += area;
    }
  }
  for (std::size_t i = 0; i < node_values.size(); ++i) {
    if (weights[i] > 0) node_values[i] /= weights[i];
  }
}

}  // namespace palpate::visualizer
