#include "haptics/vector_checks.h"

#include <cmath>

namespace palpate::haptics {

bool is_longer_than(const Vec3& v, double limit) {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return false;
  // The vector is scaled by its largest component so that squares neither overflow nor vanish.
  return (v / largest).norm() > limit / largest;
}

Vec3 clamp_length(const Vec3& v, double limit) {
  if (!is_longer_than(v, limit)) return v;
  const Vec3 scaled = v / v.cwiseAbs().maxCoeff();
  return scaled * (limit / scaled.norm());
}

std::optional<Pose> usable_pose(const Pose& pose) {
  constexpr double kShortestQuaternion = 1e-3, kLongestQuaternion = 1e3;
  if (!pose.position.allFinite() || !pose.rotation.coeffs().allFinite()) return std::nullopt;
  if (is_longer_than(pose.position, kWorldReach)) return std::nullopt;
  if (pose.rotation.coeffs().cwiseAbs().maxCoeff() > kLongestQuaternion) return std::nullopt;
  const double length = pose.rotation.norm();
  if (length < kShortestQuaternion || length > kLongestQuaternion) return std::nullopt;
  return Pose{pose.position, pose.rotation.normalized()};
}

}  // namespace palpate::haptics
