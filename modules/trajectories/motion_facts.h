// A recorded motion in a few numbers.
#pragma once

#include <cstddef>
#include <vector>

#include "modules/trajectories/timed_pose.h"

namespace palpate::trajectories {

struct MotionFacts {
  std::size_t poses = 0;
  double duration = 0;         ///< first to last [s]
  Vec3 extent = Vec3::Zero();  ///< sides of the box around positions, in the recording's frame [m]
  double fastest = 0;          ///< from pose to pose [m/s]
};

/// @param poses  at least one
MotionFacts facts_of(const std::vector<TimedPose>& poses);

}  // namespace palpate::trajectories
