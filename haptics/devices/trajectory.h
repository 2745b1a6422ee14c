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
#include "modules/trajectories/timed_pose.h"

namespace palpate::haptics {

using trajectories::TimedPose;

class Trajectory {
 public:
  /// @param samples  at least two, times increasing. The first is played at time 0
  /// @param loop     false: before the first and after the last sample the pose is held, at rest.
  ///                 true: after the last sample the pose returns to the first along the same kind
  ///                 of curve and starts again: in 0.5 s, or longer so that its mean speeds stay
  ///                 within 0.05 m/s and 1 rad/s
  Trajectory(std::vector<TimedPose> samples, bool loop);

  /// `time` [s] counts from the first sample; any finite value. Never allocates or throws.
  DeviceSample at(double time) const;

  double duration() const { return samples_.back().time; }  ///< first to last sample [s]

 private:
  struct Interval;
  struct Slopes;
  /// A sample; after the last, of a loop, the first again.
  TimedPose knot(std::size_t i) const;
  std::size_t knot_count() const { return samples_.size() + (loop_ ? 1 : 0); }
  Interval interval(std::size_t i) const;
  /// From the samples beside it, as often as they are asked for: kept, they would take as much
  /// memory as the samples, of which there may be millions.
  Slopes slopes_at(std::size_t knot) const;

  std::vector<TimedPose> samples_;  ///< the first at time 0
  bool loop_;
  double end_ = 0;  ///< time of the last knot [s]
};

}  // namespace palpate::haptics
