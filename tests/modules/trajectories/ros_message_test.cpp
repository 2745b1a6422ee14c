#include "modules/trajectories/ros_message.h"

#include <catch2/catch.hpp>
#include <vector>

using namespace palpate;
using namespace palpate::trajectories;

namespace {

/// CDR of a geometry_msgs/msg/PoseStamped, written by hand from its definition.
std::vector<std::uint8_t> cdr_pose() {
  std::vector<std::uint8_t> bytes{0, 1, 0, 0};
  const auto put = [&](const auto value) {
    while ((bytes.size() - 4) % sizeof value != 0) bytes.push_back(0);
    const auto* begin = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), begin, begin + sizeof value);
  };
  put(std::int32_t{17});
  put(std::uint32_t{500});
  put(std::uint32_t{5});
  for (const char c : {'b', 'a', 's', 'e', '\0'}) put(c);
  for (const double x : {1.0, 2.0, 3.0, 0.6, 0.0, 0.0, 0.8}) put(x);
  return bytes;
}

}  // namespace

TEST_CASE("ros message: CDR is aligned behind its encapsulation") {
  // Oracle: the bytes above; XCDR1 as ROS 2 writes it.
  StampedPose out;
  const auto bytes = cdr_pose();
  REQUIRE(decode_pose("geometry_msgs/msg/PoseStamped", RosEncoding::kCdr, bytes, out).empty());
  CHECK(out.seconds == 17);
  CHECK(out.nanoseconds == 500);
  CHECK(out.pose.position == Vec3(1, 2, 3));
  CHECK(out.pose.rotation.coeffs() == Eigen::Vector4d(0.6, 0, 0, 0.8));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto cut = std::span(bytes).first(size);
    CHECK_FALSE(decode_pose("geometry_msgs/msg/PoseStamped", RosEncoding::kCdr, cut, out).empty());
  }
}

TEST_CASE("ros message: types are known by their names in ROS 1 and 2, others are not") {
  // Oracle: kPoseTypes.
  CHECK(is_pose_type("geometry_msgs/TransformStamped"));
  CHECK(is_pose_type("geometry_msgs/msg/PointStamped"));
  CHECK_FALSE(is_pose_type("geometry_msgs/Twist"));
  CHECK_FALSE(is_pose_type("nav_msgs/PoseStamped"));
}
