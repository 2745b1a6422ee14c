#include "modules/trajectories/pose_topics.h"

#include <spdlog/fmt/fmt.h>

#include "modules/core/error.h"
#include "modules/core/units.h"

namespace palpate::trajectories {

PoseTopic PoseTopics::choose(const scene::TrajectoryDevice& config) const {
  std::string all, readable;
  PoseTopic only;
  std::size_t count = 0;
  for (const auto& [name, type] : types_) {
    all += fmt::format("{}{} ({})", all.empty() ? "" : ", ", name, type);
    if (!is_pose_type(type)) continue;
    ++count;
    only = {name, type};
    readable += (readable.empty() ? "" : ", ") + name;
  }
  const std::string file = config.file.string();
  if (config.topic) {
    const auto found = types_.find(*config.topic);
    if (found == types_.end()) {
      throw InputError(fmt::format("{}: has no topic '{}' (key topic); it has: {}", file,
                                   *config.topic, all.empty() ? "none" : all));
    }
    if (!is_pose_type(found->second)) {
      throw InputError(fmt::format("{}: topic '{}' is of type {}; allowed are {}", file,
                                   *config.topic, found->second, kPoseTypes));
    }
    return {found->first, found->second};
  }
  if (count == 1) return only;
  if (count > 1) {
    throw InputError(fmt::format("{}: has {} topics with poses; name one by key topic: {}", file,
                                 count, readable));
  }
  if (types_.contains("probe_state")) {
    throw InputError(fmt::format(
        "{0}: a recording of palpate, not a bag with poses; first: palpate inspect {0} --csv "
        "FOLDER, "
        "then FOLDER/probe_state_0.csv with columns sim_time_s, position_x_m, position_y_m, "
        "position_z_m, for a device rotation_x to rotation_w, too",
        file));
  }
  throw InputError(fmt::format("{}: has no topic with poses ({}); it has: {}", file, kPoseTypes,
                               all.empty() ? "none" : all));
}

StampedPoses::StampedPoses(const scene::TrajectoryDevice& config, PoseTopic topic,
                           RosEncoding encoding, std::vector<std::string>& warnings)
    : topic_(std::move(topic)),
      encoding_(encoding),
      metre_(metres_per_unit(config.length_unit)),
      poses_(config.file.string(), ": message ", warnings) {}

void StampedPoses::add(std::span<const std::uint8_t> message) {
  ++count_;
  StampedPose stamped;
  if (const auto wrong = decode_pose(topic_.type, encoding_, message, stamped); !wrong.empty()) {
    return poses_.leave_out(count_, wrong);
  }
  if (!origin_) origin_ = stamped.seconds;
  const double time = double(stamped.seconds - *origin_) + 1e-9 * stamped.nanoseconds;
  stamped.pose.position *= metre_;
  poses_.add(count_, time, stamped.pose);
}

}  // namespace palpate::trajectories
