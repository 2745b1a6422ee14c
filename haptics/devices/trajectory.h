// A recorded motion, resampled at any time: C1 in position and rotation, through every sample.
//
// Position: piecewise cubic Hermite with the monotone slopes of Fritsch and Butland (SIAM J. Sci.
// Stat. Comput. 5, 1984), per axis. Between two samples no coordinate leaves the interval of the
// two, so a recorded press is never deepened by the interpolation, and no coordinate moves faster
// than 1.5 times the fastest of the neighbouring sample-to-sample speeds.
//
// Rotation: the cubic Hermite quaternion curve of Kim, Kim and Shin (SIGGRAPH 1995), its end
// angular velocities chosen by the same slopes. The twist is the exact derivative of both.
#pragma once

#include <vector>

#include "haptics/devices/device.h"
#include "haptics/devices/trajectory_file.h"

namespace palpate::haptics {

class Trajectory {
 public:
  /// @param samples  at least two, times increasing. The first is played at time 0
  /// @param loop     false: before the first and after the last sample the pose is held, at rest.
  ///                 true: after the last sample the pose returns to the first along the same kind
  ///                 of curve, within return_time(), and starts again
  Trajectory(const std::vector<TimedPose>& samples, bool loop);

  /// `time` [s] counts from the first sample; any finite value. Never allocates or throws.
  DeviceSample at(double time) const;

  double duration() const { return last_sample_time_; }  ///< first to last sample [s]

  /// Duration of the way back of a loop [s]: 0.5 s, or longer so that its mean speeds stay within
  /// 0.05 m/s and 1 rad/s. 0 if not looped.
  double return_time() const { return knots_.back().time - last_sample_time_; }

 private:
  struct Knot {
    double time = 0;
    Pose pose;
    Vec3 velocity = Vec3::Zero();               ///< in the frame of the poses [m/s]
    Vec3 angular_velocity_body = Vec3::Zero();  ///< in the body's frame [rad/s]
  };
  void set_slopes();

  std::vector<Knot> knots_;
  double last_sample_time_ = 0;
  bool loop_;
};

}  // namespace palpate::haptics
