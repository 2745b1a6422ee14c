#include "modules/geometry/winding_number.h"

#include <array>
#include <cmath>
#include <numbers>

namespace palpate::geometry {
namespace {

/// Sum of the angles of complex numbers, by their product and how often it went round: an arc
/// tangent for all instead of one each.
class AngleSum {
 public:
  void add(double real, double imaginary) {
    const double re = re_ * real - im_ * imaginary, im = re_ * imaginary + im_ * real;
    const double size = std::abs(re) + std::abs(im);
    if (size == 0) return;  // an angle of nothing
    // The sum of two angles of one half plane passes π exactly where it ends in the other.
    const bool was_above = im_ >= 0;
    if (was_above == (imaginary >= 0) && was_above != (im >= 0)) turns_ += was_above ? 1 : -1;
    re_ = re / size;
    im_ = im / size;
  }
  double turns() const { return turns_ + std::atan2(im_, re_) / (2 * std::numbers::pi); }

 private:
  double turns_ = 0, re_ = 1, im_ = 0;
};

template <class NodeAt>
double winding(const Vec3& p, const NodeAt& node_at, std::span<const Triangle> triangles) {
  AngleSum half_angles;
  for (const Triangle& t : triangles) {
    std::array<Vec3, 3> r;
    for (std::size_t k = 0; k < 3; ++k) r[k] = node_at(t[k]) - p;
    const double n0 = r[0].norm(), n1 = r[1].norm(), n2 = r[2].norm();
    const double below =
        n0 * n1 * n2 + r[0].dot(r[1]) * n2 + r[0].dot(r[2]) * n1 + r[1].dot(r[2]) * n0;
    half_angles.add(below, r[0].dot(r[1].cross(r[2])));
  }
  return half_angles.turns();
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
