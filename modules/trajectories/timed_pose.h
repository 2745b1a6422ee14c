// One sample of a recorded motion.
#pragma once

#include "modules/core/types.h"

namespace palpate::trajectories {

struct TimedPose {
  double time = 0;  ///< rises from sample to sample; where 0 is, the recording decides [s]
  Pose pose;        ///< in the recording's frame
};

}  // namespace palpate::trajectories
