#include "haptics/devices/topic_device.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/core/rotation_vector.h"
#include "modules/core/tolerances.h"
#include "modules/core/units.h"
#include "modules/core/vector_checks.h"

namespace palpate::haptics {
namespace {

constexpr double kDelayShare = 0.02;  // of a sample in the mean

/// From one orientation to another [rad], in W.
Vec3 turn_between(const Quat& from, const Quat& to) {
  return vector_from_rotation(to * from.conjugate());
}

bool is_finite(const Twist& twist) { return twist.linear.allFinite() && twist.angular.allFinite(); }

/// `pose` after `time` [s] of constant `twist`.
Pose carried(const Pose& pose, const Twist& twist, double time) {
  return {pose.position + time * twist.linear,
          (rotation_from_vector(time * twist.angular) * pose.rotation).normalized()};
}

/// More than what a hand does within `time` [s]?
bool too_far(const Vec3& way, const Vec3& turn, double time) {
  return is_longer_than(way, TopicDevice::kMaxSpeed * time) ||
         is_longer_than(turn, TopicDevice::kMaxTurn * time);
}

}  // namespace

TopicDevice::TopicDevice(const scene::TopicDevice& config, const scene::Haptics& haptics)
    : stale_after_(haptics.stale_after),
      gone_after_(haptics.stale_after + haptics.fade_time),
      newest_time_(-std::numeric_limits<double>::infinity()),
      by_poses_(kToldByPoses, haptics.stale_after),
      pose_{config.start, config.rotation.normalized()} {
  newest_.pose = pose_;
}

void TopicDevice::hear(const DeviceSample& said, std::int64_t source_time_ns, std::int64_t now_ns) {
  if (!is_believable(said.pose) || !is_finite(said.twist)) return refuse();
  const double silence = seconds_from_ns(now_ns) - newest_time_;
  if (silence > stale_after_) clock_.forget();
  const auto sampled_ns = clock_.hear(source_time_ns, now_ns);
  if (!sampled_ns) return refuse();

  const double time = seconds_from_ns(*sampled_ns);
  const double way = std::max(0.0, seconds_from_ns(now_ns) - time);
  delay_ += kDelayShare * (2 * way - delay_);
  const bool jumped = too_far(said.pose.position - newest_.pose.position,
                              turn_between(newest_.pose.rotation, said.pose.rotation),
                              std::max(kShortestSpan, time - newest_time_));
  slewing_ = (slewing_ || jumped) && silence <= gone_after_;
  newest_ = said;
  newest_.pose.rotation.normalize();
  newest_time_ = time;
  by_poses_.add(time, newest_.pose);
}

bool TopicDevice::says_velocity() const {
  return !newest_.twist.linear.isZero(0) || !newest_.twist.angular.isZero(0);
}

/// From the pose before towards the sample's, as far as the limits allow within `dt`; or at once,
/// the force let go.
void TopicDevice::slew(DeviceSample& sample, double dt) {
  const Vec3 way = sample.pose.position - pose_.position;
  const Vec3 turn = turn_between(pose_.rotation, sample.pose.rotation);
  slewing_ = too_far(way, turn, dt);
  if (!slewing_) return;
  sample.limits |= kPoseSlewed;
  if (too_far(way, turn, dt + kLongestLag)) {
    slewing_ = false;
    by_poses_.clear();
    sample.twist = {};
    sample.silence = std::max(sample.silence, gone_after_);
    return;
  }
  const Vec3 step = clamp_length(way, kMaxSpeed * dt), turned = clamp_length(turn, kMaxTurn * dt);
  if (dt > 0) sample.twist = {step / dt, turned / dt};
  sample.pose = {pose_.position + step,
                 (rotation_from_vector(turned) * pose_.rotation).normalized()};
}

DeviceSample TopicDevice::read(double time) {
  const double age = std::isfinite(time) ? std::max(0.0, time - newest_time_) : 0;
  const double dt = std::isfinite(time) ? std::clamp(time - last_time_, 0.0, kLongestStep) : 0;
  if (std::isfinite(time)) last_time_ = time;

  DeviceSample sample = newest_;
  sample.silence = age;
  sample.delay = delay_;
  sample.limits = limits_;
  limits_ = kForceNotLimited;
  const bool rests = age >= kLongestCarry;
  const Twist moves = says_velocity() ? newest_.twist : by_poses_.twist();
  const bool too_fast = !rests && too_far(newest_.twist.linear, newest_.twist.angular, 1);
  sample.twist = {clamp_length(moves.linear, kMaxSpeed), clamp_length(moves.angular, kMaxTurn)};
  if (says_velocity()) {
    sample.pose = carried(newest_.pose, sample.twist, std::min(age, kLongestCarry));
  }
  if (rests) sample.twist = {};
  if (too_fast) sample.limits |= kPoseSlewed;
  if (slewing_) slew(sample, dt);
  pose_ = sample.pose;
  return sample;
}

}  // namespace palpate::haptics
