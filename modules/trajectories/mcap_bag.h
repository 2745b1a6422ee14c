// Reads a motion from an MCAP file, which is what bags of ROS 2 are: messages in CDR, or of ROS 1.
#pragma once

#include "modules/scene/scene.h"
#include "modules/trajectories/progress.h"
#include "modules/trajectories/timed_pose.h"

namespace palpate::trajectories {

/// Times as in read_ros_bag(). Read twice, a chunk at a time; also one that was never closed.
/// @throws InputError  for a file that is no MCAP, holds chunks that are damaged or compressed in a
///                     way that is not read, or not one topic that is meant; with the topics there
///                     are
std::vector<TimedPose> read_mcap_bag(const scene::TrajectoryDevice& config,
                                     std::vector<std::string>& warnings, const Progress& progress);

}  // namespace palpate::trajectories
