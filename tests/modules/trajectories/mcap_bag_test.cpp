// Bags as ROS 2 writes them, by npm's MCAP writer (make_mcap_bags.mjs), and the same bytes spoiled.
#include "modules/trajectories/mcap_bag.h"

#include <catch2/catch.hpp>

#include "tests/modules/trajectories/bags.h"

using namespace palpate;
using namespace palpate::trajectories;
using namespace palpate::trajectories::testing;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;

TEST_CASE("mcap bag: poses and transforms of the topic named, by their own stamps") {
  // Oracle: the formulas of make_mcap_bags.mjs.
  struct Expected {
    const char* file;
    std::optional<std::string> topic;
    double speed;
    Quat rotation;
  };
  const auto expected =
      GENERATE(values<Expected>({{"one.mcap", {}, 0.001, Quat(0.8, 0.6, 0, 0)},
                                 {"topics.mcap", "/tool/pose", 0.001, Quat(0.8, 0.6, 0, 0)},
                                 {"topics.mcap", "/tf_tip", 0.002, Quat(0.8, 0, 0.6, 0)}}));
  std::vector<std::string> warnings;
  const auto poses =
      read_trajectory({.file = kBags / expected.file, .topic = expected.topic}, warnings);
  CHECK(warnings.empty());
  REQUIRE(poses.size() == 50);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    CHECK(poses[i].time - poses[0].time == Approx(0.01 * double(i)).margin(1e-12));
    CHECK((poses[i].pose.position - Vec3(expected.speed * double(i), -0.5, 0.25)).norm() < 1e-15);
    CHECK((poses[i].pose.rotation.coeffs() - expected.rotation.coeffs()).norm() < 1e-15);
  }
}

TEST_CASE("mcap bag: what cannot be used is refused and says what there is") {
  // Oracle: make_mcap_bags.mjs, the stated rules.
  CHECK_THAT(bag_error({.file = kBags / "topics.mcap"}),
             EndsWith("has 2 topics with poses; name one by key topic: /tf_tip, /tool/pose"));
  CHECK_THAT(bag_error({.file = kBags / "one.mcap", .topic = "/cmd_vel"}),
             Contains("is of type geometry_msgs/msg/Twist; allowed are geometry_msgs/PoseStamped"));
  const ScratchFolder folder;
  CHECK_THAT(bag_error({.file = folder.write("text.mcap", "t,x,y,z,qx,qy,qz,qw\n")}),
             Contains("text.mcap"));
  CHECK_THAT(bag_error({.file = folder / "none.mcap"}), Contains("none.mcap"));
  std::string other = text_in(kBags / "one.mcap");
  for (std::size_t at = 0; (at = other.find("cdr", at)) != std::string::npos; ++at)
    other.replace(at, 3, "xdr");
  CHECK(bag_error({.file = folder.write("xdr.mcap", other)}) != "accepted");
}

TEST_CASE("mcap bag: one that is cut is read up to there, and says so") {
  CHECK_THAT(warning_of_cut("one.mcap", 8000),
             EndsWith("cut_one.mcap: has no end; what is before it is used"));
}

TEST_CASE("mcap bag: no spoiled byte does more than be refused") { check_spoiled("one.mcap"); }
