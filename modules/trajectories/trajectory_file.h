// Reads a recorded motion, whatever kind of file it is in.
#pragma once

#include <string>
#include <vector>

#include "modules/scene/scene.h"
#include "modules/trajectories/progress.h"
#include "modules/trajectories/timed_pose.h"

namespace palpate::trajectories {

/// @param config  `file` and what is said of it; where it is placed in the world is not looked at
/// @returns at least two poses in SI units, times strictly rising (pose_collector.h has the rules)
/// @throws InputError "file:line: …" or "file: message N: …" for one that cannot be used
std::vector<TimedPose> read_trajectory(const scene::TrajectoryDevice& config,
                                       std::vector<std::string>& warnings,
                                       const Progress& progress = {});

}  // namespace palpate::trajectories
