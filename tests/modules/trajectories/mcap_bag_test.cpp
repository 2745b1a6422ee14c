// Bags as ROS 2 writes them, by npm's MCAP writer (make_mcap_bags.mjs), and the same bytes spoiled.
#include "modules/trajectories/mcap_bag.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "modules/trajectories/trajectory_file.h"
#include "tests/scratch_folder.h"

using namespace palpate;
using namespace palpate::trajectories;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;

namespace {

const std::filesystem::path kMcapBags =
    std::filesystem::path(PALPATE_SOURCE_DIR) / "tests/modules/trajectories/bags";

std::string mcap_error(const scene::TrajectoryDevice& config) {
  std::vector<std::string> warnings;
  try {
    read_trajectory(config, warnings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

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
      read_trajectory({.file = kMcapBags / expected.file, .topic = expected.topic}, warnings);
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
  CHECK_THAT(mcap_error({.file = kMcapBags / "topics.mcap"}),
             EndsWith("has 2 topics with poses; name one by key topic: /tf_tip, /tool/pose"));
  CHECK_THAT(mcap_error({.file = kMcapBags / "one.mcap", .topic = "/cmd_vel"}),
             Contains("is of type geometry_msgs/msg/Twist; allowed are geometry_msgs/PoseStamped"));
  const ScratchFolder folder;
  CHECK_THAT(mcap_error({.file = folder.write("text.mcap", "t,x,y,z,qx,qy,qz,qw\n")}),
             Contains("text.mcap"));
  CHECK_THAT(mcap_error({.file = folder / "none.mcap"}), Contains("none.mcap"));
  std::string other = text_in(kMcapBags / "one.mcap");
  for (std::size_t at = 0; (at = other.find("cdr", at)) != std::string::npos; ++at)
    other.replace(at, 3, "xdr");
  CHECK(mcap_error({.file = folder.write("xdr.mcap", other)}) != "accepted");
}

TEST_CASE("mcap bag: one that is cut is read up to there, and says so") {
  // Oracle: the bytes left out.
  const ScratchFolder folder;
  const std::string whole = text_in(kMcapBags / "one.mcap");
  const scene::TrajectoryDevice config{.file = folder.write("cut.mcap", whole.substr(0, 8000))};
  std::vector<std::string> warnings;
  const auto poses = read_trajectory(config, warnings);
  CHECK(poses.size() >= 2);
  CHECK(poses.size() < 50);
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], EndsWith("cut.mcap: has no end; what is before it is used"));
}

TEST_CASE("mcap bag: no spoiled byte does more than be refused") {
  // Oracle: none but the sanitizers and this: poses or an InputError.
  const ScratchFolder folder;
  const std::string whole = text_in(kMcapBags / "one.mcap");
  std::size_t refused = 0;
  for (std::size_t i = 0; i < whole.size(); i += 97) {
    std::string spoiled = whole;
    spoiled[i] = char(~spoiled[i]);
    const auto said = mcap_error({.file = folder.write("spoiled.mcap", spoiled)});
    refused += said != "accepted";
  }
  CHECK(refused > 0);
}
