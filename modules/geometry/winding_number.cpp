#include "modules/geometry/winding_number.h"

#include <array>
#include <cmath>
#include <numbers>

namespace palpate::geometry {
namespace {

template <class NodeAt>
double winding(const Vec3& p, const NodeAt& node_at, std::span<const Triangle> triangles) {
  double solid_angle = 0;
  for (const Triangle& t : triangles) {
    std::array<Vec3, 3> r;
    for (std::size_t k = 0; k < 3; ++k) r[k] = node_at(t[k]) - p;
    const double n0 = r[0].norm(), n1 = r[1].norm(), n2 = r[2].norm();
    const double below =
        n0 * n1 * n2 + r[0].dot(r[1]) * n2 + r[0].dot(r[2]) * n1 + r[1].dot(r[2]) * n0;
    solid_angle += 2 * std::atan2(r[0].dot(r[1].cross(r[2])), below);
  }
  return solid_angle / (4 * std::numbers::pi);
}

}  // namespace

double winding_number(const Vec3& p, std::span<const Vec3> nodes,
                      std::span<const Triangle> triangles) {
  return winding(
      p, [&](std::uint32_t node) -> const Vec3& { return nodes[node]; }, triangles);
}

double winding_number(const Vec3& p, std::span<const float> positions,
                      std::span<const Triangle> triangles) {
  return winding(
      p,
      [&](std::uint32_t node) -> Vec3 {
        return Eigen::Map<const Eigen::Vector3f>(&positions[3 * std::size_t{node}]).cast<double>();
      },
      triangles);
}

}  // namespace palpate::geometry
