#include "modules/trajectories/trajectory_file.h"

#include "modules/trajectories/ros_bag.h"
#include "modules/trajectories/table.h"

namespace palpate::trajectories {

std::vector<TimedPose> read_trajectory(const scene::TrajectoryDevice& config,
                                       std::vector<std::string>& warnings,
                                       const Progress& progress) {
  return (config.is_bag() ? read_ros_bag : read_table)(config, warnings, progress);
}

}  // namespace palpate::trajectories
