// Directions that a feature of a surface, or one of many features, faces.
#pragma once

#include <cmath>
#include <numbers>

#include "modules/core/types.h"

namespace palpate::collision {

/// Sine of the angle by which an edge may be touched from beyond its two faces.
inline constexpr double kConeSlack = 0.02;

/// All directions within an angle of an axis.
class NormalCone {
 public:
  /// All there are.
  NormalCone() = default;
  /// @param axis   unit
  /// @param angle  [rad]; below 0: no direction
  NormalCone(const Vec3& axis, double angle)
      : axis_(axis), angle_(angle), cos_(std::cos(angle)), sin_(std::sin(angle)) {}

  const Vec3& axis() const { return axis_; }
  double angle() const { return angle_; }
  bool is_empty() const { return angle_ < 0; }
  /// Whether a direction of this may be against one of the other.
  bool may_oppose(const NormalCone& other) const {
    if (is_empty() || other.is_empty()) return false;
    return angle_ + other.angle_ >= std::numbers::pi ||
           -axis_.dot(other.axis_) >= cos_ * other.cos_ - sin_ * other.sin_;
  }

 private:
  Vec3 axis_ = Vec3::UnitZ();
  double angle_ = std::numbers::pi, cos_ = -1, sin_ = 0;
};

/// The directions in which an edge of two triangles may be touched before either of them: between
/// their normals, and beyond them by a little more than kConeSlack. Of an edge in a dent none.
/// @param one, other  unit normals
/// @param into_other  in the plane of the other, away from the edge
inline NormalCone cone_of_edge(const Vec3& one, const Vec3& other, const Vec3& into_other) {
  constexpr double kSlack = kConeSlack + 1e-3;  // [rad]
  const Vec3 sum = one + other;
  if (sum.norm() < 1e-6) return {};
  const double half = std::atan2(one.cross(other).norm(), one.dot(other)) / 2;
  return {sum.normalized(), (one.dot(into_other) > 0 ? -half : half) + kSlack};
}

}  // namespace palpate::collision
