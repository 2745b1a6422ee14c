#include "haptics/devices/mouse_device.h"

#include <algorithm>
#include <cmath>

#include "modules/core/rotation_vector.h"
#include "modules/core/tolerances.h"
#include "modules/core/vector_checks.h"

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

MouseDevice::MouseDevice(const scene::MouseDevice& config) {
  current_.pose = {config.start, config.rotation.normalized()};
  target_ = current_.pose;
}

void MouseDevice::hear(const DeviceSample& said, std::int64_t, std::int64_t) {
  if (!is_believable(said.pose)) return refuse();
  target_ = {said.pose.position, said.pose.rotation.normalized()};
  current_.buttons = said.buttons;
}

DeviceSample MouseDevice::read(double time) {
  // Bounded: after a pause in reading the probe goes on from where it was; and a clock set back
  // is a step of no length.
  const double dt = std::isfinite(time) ? std::clamp(time - last_time_, 0.0, kLongestStep) : 0;
  if (std::isfinite(time)) last_time_ = time;
  if (dt > 0) {
    Pose& pose = current_.pose;
    pose.position += follow(target_.position - pose.position, kMaxSpeed, dt, current_.twist.linear);
    const Vec3 error = vector_from_rotation(target_.rotation * pose.rotation.conjugate());
    const Vec3 turn = follow(error, kMaxTurn, dt, current_.twist.angular);
    pose.rotation = (rotation_from_vector(turn) * pose.rotation).normalized();
  }
  const DeviceSample sample = current_;
  current_.limits = kForceNotLimited;  // said once
  return sample;
}

}  // namespace palpate::haptics
