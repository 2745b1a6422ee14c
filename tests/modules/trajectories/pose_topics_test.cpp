#include "modules/trajectories/pose_topics.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"

using namespace palpate;
using namespace palpate::trajectories;

TEST_CASE("pose topics: the one named, or the only one") {
  // Oracle: the stated rule.
  PoseTopics topics;
  CHECK_THROWS_WITH(topics.choose({.file = "a.bag"}), Catch::Contains("it has: none"));
  topics.add("/twist", "geometry_msgs/Twist");
  CHECK_THROWS_WITH(topics.choose({.file = "a.bag"}),
                    Catch::Contains("/twist (geometry_msgs/Twist)"));
  topics.add("/pose", "geometry_msgs/PoseStamped");
  CHECK(topics.choose({.file = "a.bag"}).name == "/pose");
  topics.add("/tf", "geometry_msgs/TransformStamped");
  CHECK_THROWS_AS(topics.choose({.file = "a.bag"}), InputError);
  CHECK(topics.choose({.file = "a.bag", .topic = "/tf"}).type == "geometry_msgs/TransformStamped");
}

TEST_CASE("pose topics: of a recording of palpate it says how it becomes a table") {
  // Oracle: the way by hand: `inspect --csv` writes these columns (csv.h).
  PoseTopics topics;
  topics.add("probe_state", "palpate::idl::ProbeState");
  CHECK_THROWS_WITH(topics.choose({.file = "a.mcap"}),
                    "a.mcap: a recording of palpate, not a bag with poses; first: palpate inspect "
                    "a.mcap --csv FOLDER, then FOLDER/probe_state_0.csv with columns sim_time_s, "
                    "position_x_m, position_y_m, position_z_m, for a device rotation_x to "
                    "rotation_w, too");
}

TEST_CASE("pose topics: a message that is none is left out by its number") {
  // Oracle: the stated form.
  std::vector<std::string> warnings;
  StampedPoses poses({.file = "a.bag"}, {"/pose", "geometry_msgs/PoseStamped"}, RosEncoding::kRos1,
                     warnings);
  poses.add({});
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0] == "a.bag: message 1: left out: is shorter than its type");
  CHECK_THROWS_AS(std::move(poses).finish(), InputError);
}
