// Reads a motion from a ROS 1 bag, format 2.0 (wiki.ros.org/Bags/Format/2.0), front to back: also
// from one that was never closed.
#pragma once

#include "modules/scene/scene.h"
#include "modules/trajectories/progress.h"
#include "modules/trajectories/timed_pose.h"

namespace palpate::trajectories {

/// Times are the messages' own stamps, counted from the second of the first. Read twice, a chunk at
/// a time; memory is that of the poses.
/// @throws InputError  for a file that is no such bag, holds compressed chunks, or not one topic
///                     that is meant; with the topics there are
std::vector<TimedPose> read_ros_bag(const scene::TrajectoryDevice& config,
                                    std::vector<std::string>& warnings, const Progress& progress);

}  // namespace palpate::trajectories
