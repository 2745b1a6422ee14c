#include "haptics/passivity.h"

#include <algorithm>
#include <cmath>

#include "modules/core/rotation_vector.h"

namespace palpate::haptics {
namespace {

/// Slower than this there is no power to speak of: 3 N give 3 µW [m/s].
constexpr double kStandstill = 1e-6;
/// Of readings; reached after 0.92 kRestTime of standing still.
constexpr double kMost = 0.6;

/// How far apart, a turn counted at the arm [m].
double way(const Pose& a, const Pose& b) {
  const Vec3 turned = vector_from_rotation(a.rotation * b.rotation.conjugate());
  return std::hypot((a.position - b.position).stableNorm(),
                    PassivityControl::kArm * turned.stableNorm());
}

}  // namespace

void PassivityControl::watch(const Pose& pose) {
  if (!(way(pose, rest_pose_) <= kRestWay)) {
    rest_pose_ = pose;
    stillness_ = 0;
  }
  const bool still = pose.position == pose_.position && pose.rotation == pose_.rotation;
  stillness_ += ((still ? 1.0 : 0.0) - stillness_) * std::min(1.0, period_ / kRestTime);
  pose_ = pose;
}

void PassivityControl::observe(const Pose& pose, double returnable) {
  if (has_pose_) {
    const Vec3 moved = pose.position - pose_.position;
    const Vec3 turned = vector_from_rotation(pose.rotation * pose_.rotation.conjugate());
    const double gained = -held_.force.dot(moved) - held_.torque.dot(turned) +
                          damping_ * moved.squaredNorm() / period_;
    if (std::isfinite(gained)) energy_ += gained;
  }
  watch(pose);
  const double strength = held_.force.stableNorm() + held_.torque.stableNorm() / kArm;
  if (stillness_ > kMost && energy_ <= strength * kRestWay) energy_ = returnable;
  energy_ = std::clamp(energy_, -kMaxDebt, returnable);
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
  const double most =
      std::max(0.0, push) * std::min(1.0, speed / kFirmFrom) + kMaxAddedDamping * speed;
  const double taken = std::min(needed, most);
  return {wanted.force - taken * along, wanted.torque - taken * kArm * kArm * around};
}

void PassivityControl::clear() {
  energy_ = 0;
  has_pose_ = false;
  held_ = {};
}

}  // namespace palpate::haptics
