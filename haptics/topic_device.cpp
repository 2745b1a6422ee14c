// Follows the newest commanded pose as a critically damped second-order system with limited speed.
//
// Wanted velocity u = clamp(k e, v_max), e = target − pose; velocity v̇ = 4k (u − v). Without the
// clamp ë + 4k ė + 4k² e = 0: critically damped with ω = 2k. v is a mean of past u, hence never
// faster than v_max; leaving the clamp, e = (v_max/k)(1 + k t) exp(−2k t) does not overshoot.
// A ramp is followed 1/k behind.
#include <algorithm>
#include <cmath>

#include "haptics/device.h"
#include "haptics/rotation_vector.h"
#include "haptics/vector_checks.h"
#include "modules/core/tolerances.h"

namespace palpate::haptics {
namespace {

constexpr double kGain = 50;  ///< k [1/s]

/// One step of v̇ = 4k (u − v), exact for constant u. @returns the way made
Vec3 follow(const Vec3& error, double max_speed, double dt, Vec3& velocity) {
  const Vec3 wanted = clamp_length(kGain * error, max_speed);
  const double decay = std::exp(-4 * kGain * dt);
  const Vec3 excess = velocity - wanted;
  velocity = wanted + decay * excess;
  return dt * wanted + (1 - decay) / (4 * kGain) * excess;
}

}  // namespace

TopicDevice::TopicDevice(const scene::TopicDevice& config) {
  current_.pose = {config.start, config.rotation.normalized()};
  target_ = current_.pose;
}

void TopicDevice::command(const Pose& commanded, std::uint32_t buttons) {
  if (!is_believable(commanded)) return;
  target_ = {commanded.position, commanded.rotation.normalized()};
  current_.buttons = buttons;
}

DeviceSample TopicDevice::read(double time) {
  // Bounded: after a pause in reading the probe goes on from where it was; and a clock set back
  // is a step of no length.
  const double dt = std::isfinite(time) ? std::clamp(time - last_time_, 0.0, kLongestStep) : 0;
  if (std::isfinite(time)) last_time_ = time;
  if (dt == 0) return current_;

  Pose& pose = current_.pose;
  pose.position += follow(target_.position - pose.position, kMaxSpeed, dt, current_.twist.linear);
  const Vec3 error = vector_from_rotation(target_.rotation * pose.rotation.conjugate());
  const Vec3 turn = follow(error, kMaxTurn, dt, current_.twist.angular);
  pose.rotation = (rotation_from_vector(turn) * pose.rotation).normalized();
  return current_;
}

}  // namespace palpate::haptics
