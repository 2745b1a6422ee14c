// Bags written by ROS's own rosbag 1.15 (make_bags.py), and the same bytes spoiled.
#include "modules/trajectories/ros_bag.h"

#include <catch2/catch.hpp>

#include "tests/modules/trajectories/bags.h"

using namespace palpate;
using namespace palpate::trajectories;
using namespace palpate::trajectories::testing;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;

namespace {

std::vector<TimedPose> poses_of(const scene::TrajectoryDevice& config) {
  std::vector<std::string> warnings;
  auto poses = read_trajectory(config, warnings);
  CHECK(warnings.empty());
  return poses;
}

}  // namespace

TEST_CASE("ros bag: poses, transforms and points of the topic named, by their own stamps") {
  // Oracle: the formulas of make_bags.py.
  struct Expected {
    const char* topic;
    double speed;
    Vec3 rest;
    Quat rotation;
  };
  const auto expected =
      GENERATE(values<Expected>({{"/tool/pose", 0.001, Vec3(0, -0.5, 0.25), Quat(0.8, 0.6, 0, 0)},
                                 {"/tool/tf", 0.002, Vec3(0, -0.5, 0.25), Quat(0.8, 0, 0.6, 0)},
                                 {"/tool/point", 0.003, Vec3::Zero(), Quat(1, 0, 0, 0)}}));
  const auto poses = poses_of({.file = kBags / "topics.bag", .topic = expected.topic});
  REQUIRE(poses.size() == 50);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    CHECK(poses[i].time - poses[0].time == Approx(0.01 * double(i)).margin(1e-12));
    CHECK(poses[i].pose.position == Vec3(expected.speed * double(i), 0, 0) + expected.rest);
    CHECK((poses[i].pose.rotation.coeffs() - expected.rotation.coeffs()).norm() < 1e-15);
  }
}

TEST_CASE("ros bag: the only topic with poses needs no name, and its length unit may be another") {
  // Oracle: make_bags.py.
  const auto poses = poses_of({.file = kBags / "one.bag", .length_unit = "cm"});
  CHECK(poses.size() == 50);
  CHECK(poses[0].pose.position.isApprox(Vec3(0, -0.005, 0.0025)));
}

TEST_CASE("ros bag: what cannot be used is refused and says what there is") {
  // Oracle: make_bags.py, the stated rules.
  const auto many = kBags / "topics.bag";
  CHECK_THAT(bag_error({.file = many}),
             EndsWith("has 3 topics with poses; name one by key topic: /tool/point, /tool/pose, "
                      "/tool/tf"));
  CHECK_THAT(bag_error({.file = many, .topic = "/tool"}),
             Contains("has no topic '/tool' (key topic); it has: ") &&
                 Contains("/tool/twist (geometry_msgs/Twist)"));
  CHECK_THAT(bag_error({.file = many, .topic = "/tool/twist"}),
             Contains("is of type geometry_msgs/Twist; allowed are geometry_msgs/PoseStamped"));
  CHECK_THAT(bag_error({.file = kBags / "bz2.bag"}),
             EndsWith("bz2.bag: is compressed (bz2); first: rosbag decompress bz2.bag"));
  const ScratchFolder folder;
  CHECK_THAT(bag_error({.file = folder.write("text.bag", "t,x,y,z,qx,qy,qz,qw\n")}),
             EndsWith("text.bag: is no ROS 1 bag of format 2.0"));
  CHECK_THAT(bag_error({.file = folder / "none.bag"}), EndsWith("none.bag: no such file"));
}

TEST_CASE("ros bag: one that is cut is read up to there, and says so") {
  CHECK_THAT(warning_of_cut("one.bag", 12000),
             Contains("cut_one.bag: ends within a record, at byte "));
}

TEST_CASE("ros bag: no spoiled byte does more than be refused") { check_spoiled("one.bag"); }
