// Poses in messages of ROS: geometry_msgs, as ROS 1 serialises them or as CDR (ROS 2).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "modules/core/types.h"

namespace palpate::trajectories {

/// The types that are read, for people.
inline constexpr const char* kPoseTypes =
    "geometry_msgs/PoseStamped, PoseWithCovarianceStamped, TransformStamped, PointStamped";

enum class RosEncoding { kRos1, kCdr };

struct StampedPose {
  std::int64_t seconds = 0;       ///< of the header's stamp
  std::uint32_t nanoseconds = 0;  ///< of it
  Pose pose;                      ///< of a point: without rotation
  std::string_view frame;         ///< the header's, in the message's bytes
  std::string_view child_frame;   ///< of a transform: what moves; else empty
};

/// @param type  "geometry_msgs/PoseStamped" or, of ROS 2, "geometry_msgs/msg/PoseStamped"
bool is_pose_type(std::string_view type);

/// @param type  one of which is_pose_type() holds
/// @returns what is wrong with the bytes, empty if nothing
std::string decode_pose(std::string_view type, RosEncoding encoding,
                        std::span<const std::uint8_t> bytes, StampedPose& out);

}  // namespace palpate::trajectories
