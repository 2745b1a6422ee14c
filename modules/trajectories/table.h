// Reads a motion from a table: a text with one pose a line. Lines that begin with # and empty ones
// are left out; the first other line is the header, if columns are not all numbers.
#pragma once

#include "modules/scene/scene.h"
#include "modules/trajectories/progress.h"
#include "modules/trajectories/timed_pose.h"

namespace palpate::trajectories {

/// Line by line, each looked at once; memory is that of the poses, 80 bytes each.
/// @throws InputError "file:line: …"
std::vector<TimedPose> read_table(const scene::TrajectoryDevice& config,
                                  std::vector<std::string>& warnings, const Progress& progress);

}  // namespace palpate::trajectories
