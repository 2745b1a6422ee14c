#include "haptics/passivity.h"

#include <algorithm>
#include <cmath>

#include "modules/core/rotation_vector.h"

namespace palpate::haptics {
namespace {

/// Slower than this there is no power to speak of: 3 N give 3 µW [m/s].
constexpr double kStandstill = 1e-6;

}  // namespace

void PassivityControl::observe(const Pose& pose, double returnable) {
  if (has_pose_) {
    const Vec3 moved = pose.position - pose_.position;
    const Vec3 turned = vector_from_rotation(pose.rotation * pose_.rotation.conjugate());
    const double gained = -held_.force.dot(moved) - held_.torque.dot(turned) +
                          damping_ * moved.squaredNorm() / period_;
    if (std::isfinite(gained)) energy_ += gained;
    energy_ = std::clamp(energy_, -kMaxDebt, returnable);
  }
  pose_ = pose;
  has_pose_ = true;
}

Wrench PassivityControl::controlled(const Wrench& wanted, const Twist& twist) const {
  const double speed = std::hypot(twist.linear.stableNorm(), kArm * twist.angular.stableNorm());
  if (!(speed > kStandstill) || !std::isfinite(speed)) return wanted;
  const Vec3 along = twist.linear / speed, around = twist.angular / speed;
  const double push = wanted.force.dot(along) + wanted.torque.dot(around);
  const double lost = damping_ * speed * along.squaredNorm();
  const double energy_after = energy_ - period_ * speed * (push - lost);
  if (!(energy_after < 0)) return wanted;
  const double needed = -energy_after / (period_ * speed);
  const double taken = std::min(needed, std::max(0.0, push) + kMaxAddedDamping * speed);
  return {wanted.force - taken * along, wanted.torque - taken * kArm * kArm * around};
}

void PassivityControl::clear() {
  energy_ = 0;
  has_pose_ = false;
  held_ = {};
}

}  // namespace palpate::haptics
