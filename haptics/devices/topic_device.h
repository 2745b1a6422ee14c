// A real device: the pose that its driver writes, as it comes. What lies between the hand and the
// force is delay, and delay is what makes a touch unstable, so nothing is smoothed: the newest pose
// is carried to the tick by its own twist, that is all.
#pragma once

#include "haptics/devices/device.h"
#include "haptics/devices/driver_clock.h"
#include "haptics/devices/pose_speed.h"

namespace palpate::haptics {

class TopicDevice final : public OutsideDevice {
 public:
  /// Further than this a pose is not carried; then it rests [s].
  static constexpr double kLongestCarry = 0.01;
  /// No hand is faster. A driver that is, from one sample to the next or by its twist, is followed
  /// at this speed until it is caught up with, and kPoseSlewed says so. What takes longer than
  /// kLongestLag is no motion: the probe is where its driver is, and the force is let go and rises
  /// again as after a silence, for on the way it would be that of places where no hand was.
  static constexpr double kMaxSpeed = 2;        ///< [m/s]
  static constexpr double kMaxTurn = 20;        ///< [rad/s]
  static constexpr double kLongestStep = 0.01;  ///< of one read() while slewed [s]
  static constexpr double kLongestLag = 0.01;   ///< [s]; 20 mm
  /// Of a driver that says no velocity: over so long, two samples at least, its poses tell it [s].
  static constexpr double kToldByPoses = 0.01;
  /// Samples are taken to be at least this far apart: stamps come with jitter [s].
  static constexpr double kShortestSpan = 1e-3;

  /// @param haptics  a driver silent for `stale_after` may have another clock when it returns;
  ///                 when its force has faded, too, it returns where it is and not slewed
  TopicDevice(const scene::TopicDevice& config, const scene::Haptics& haptics);
  /// Refused, and said so by kPoseRefused in the next read(): a pose that is not believable
  /// (is_believable()), a twist that is not finite, a stamp not later than the one before.
  void hear(const DeviceSample& said, std::int64_t source_time_ns, std::int64_t now_ns) override;
  void refuse() override { limits_ |= kPoseRefused; }
  Clock clock() const override { return Clock::kSource; }  // a hand does not pause
  DeviceSample read(double time) override;

  void exchange(StateArchive& archive) override {
    archive(clock_, newest_, newest_time_, by_poses_, pose_, last_time_, delay_, slewing_, limits_);
  }

 private:
  bool says_velocity() const;
  void slew(DeviceSample& sample, double dt);

  double stale_after_, gone_after_;  ///< [s]
  DriverClock clock_;
  DeviceSample newest_;   ///< as the driver said it
  double newest_time_;    ///< when it was sampled [s]
  PoseSpeed by_poses_;    ///< of what was heard
  Pose pose_;             ///< of the last read()
  double last_time_ = 0;  ///< of the last read() [s]
  double delay_ = 0;      ///< of samples on their way here, twice: forces go back as long [s]
  bool slewing_ = false;  ///< pose_ is behind the driver
  std::uint32_t limits_ = kForceNotLimited;  ///< for the next read()
};

}  // namespace palpate::haptics
