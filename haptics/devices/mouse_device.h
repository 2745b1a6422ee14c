// A probe that follows a mouse: smoothly, behind it, and never faster than told to. A mouse moves
// in steps of a picture's time and jumps where it likes; no hand feels the force.
//
// Wanted velocity u = clamp(k e, v_max), e = target − pose; velocity v̇ = 4k (u − v). Without the
// clamp ë + 4k ė + 4k² e = 0: critically damped with ω = 2k. v is a mean of past u, hence never
// faster than v_max; leaving the clamp, e = (v_max/k)(1 + k t) exp(−2k t) does not overshoot.
// A ramp is followed 1/k behind.
#pragma once

#include "haptics/devices/device.h"

namespace palpate::haptics {

class MouseDevice final : public OutsideDevice {
 public:
  static constexpr double kMaxSpeed = 0.5;      ///< [m/s]
  static constexpr double kMaxTurn = 6.3;       ///< [rad/s]
  static constexpr double kLongestStep = 0.01;  ///< of one read(), whatever time has passed [s]
  static constexpr double kRampDelay = 0.02;    ///< how far behind a steady motion it is [s]

  explicit MouseDevice(const scene::MouseDevice& config);
  /// A pose that is not believable (is_believable()) is refused. Times do not matter: the newest
  /// holds until the next.
  void hear(const DeviceSample& said, std::int64_t source_time_ns, std::int64_t now_ns) override;
  void refuse() override { current_.limits = kPoseRefused; }
  DeviceSample read(double time) override;

  void exchange(StateArchive& archive) override { archive(current_, target_, last_time_); }

 private:
  DeviceSample current_;
  Pose target_;
  double last_time_ = 0;
};

}  // namespace palpate::haptics
