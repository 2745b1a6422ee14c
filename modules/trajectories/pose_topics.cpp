#include "modules/trajectories/pose_topics.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>

#include "modules/core/error.h"
#include "modules/core/units.h"

namespace palpate::trajectories {
namespace {

constexpr std::size_t kFramesTold = 10;
constexpr std::size_t kFrameLetters = 80;

/// ROS 1 writes "/world" and "world" for the same.
std::string frame_text(std::string_view name) {
  if (name.starts_with('/')) name.remove_prefix(1);
  std::string text(name.substr(0, kFrameLetters));
  for (char& c : text) c = static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return "'" + text + "'";
}

}  // namespace

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
    : file_(config.file.string()),
      topic_(std::move(topic)),
      encoding_(encoding),
      metre_(metres_per_unit(config.length_unit)),
      poses_(config.file.string(), ": message ", warnings) {}

void StampedPoses::add(std::span<const std::uint8_t> message) {
  ++count_;
  StampedPose stamped;
  if (const auto wrong = decode_pose(topic_.type, encoding_, message, stamped); !wrong.empty()) {
    return poses_.leave_out(count_, wrong);
  }
  note_frame(stamped);
  if (!origin_) origin_ = stamped.seconds;
  const double time = double(stamped.seconds - *origin_) + 1e-9 * stamped.nanoseconds;
  stamped.pose.position *= metre_;
  poses_.add(count_, time, stamped.pose);
}

void StampedPoses::note_frame(const StampedPose& stamped) {
  if (!frames_.empty() && stamped.frame == frame_ && stamped.child_frame == child_frame_) return;
  frame_ = stamped.frame;
  child_frame_ = stamped.child_frame;
  std::string frame = frame_text(stamped.frame);
  if (!stamped.child_frame.empty()) frame = frame_text(stamped.child_frame) + " in " + frame;
  if (frames_.size() < kFramesTold && std::ranges::find(frames_, frame) == frames_.end()) {
    frames_.push_back(std::move(frame));
  }
}

std::vector<TimedPose> StampedPoses::finish() && {
  if (frames_.size() > 1) {
    throw InputError(fmt::format(
        "{}: topic '{}' holds poses of several frames ({}{}), which are no single motion; write "
        "the one that is meant to a topic of its own",
        file_, topic_.name, fmt::join(frames_, ", "), frames_.size() == kFramesTold ? ", …" : ""));
  }
  return std::move(poses_).finish(count_);
}

}  // namespace palpate::trajectories
