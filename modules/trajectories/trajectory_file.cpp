#include "modules/trajectories/trajectory_file.h"

#include <new>
#include <stdexcept>

#include "modules/scene/motion_file.h"
#include "modules/trajectories/mcap_bag.h"
#include "modules/trajectories/ros_bag.h"
#include "modules/trajectories/table.h"

namespace palpate::trajectories {

namespace {

std::vector<TimedPose> read_by_kind(const scene::TrajectoryDevice& config,
                                    std::vector<std::string>& warnings, const Progress& progress) {
  switch (scene::motion_file_of(config.file)) {
    case scene::MotionFile::kRos1Bag:
      return read_ros_bag(config, warnings, progress);
    case scene::MotionFile::kMcapBag:
      return read_mcap_bag(config, warnings, progress);
    default:
      return read_table(config, warnings, progress);
  }
}

}  // namespace

std::vector<TimedPose> read_trajectory(const scene::TrajectoryDevice& config,
                                       std::vector<std::string>& warnings,
                                       const Progress& progress) {
  try {
    return read_by_kind(config, warnings, progress);
  } catch (const std::bad_alloc&) {
    throw std::runtime_error("not enough memory to read " + config.file.string());
  }
}

}  // namespace palpate::trajectories
