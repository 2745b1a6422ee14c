#include "modules/trajectories/pose_topics.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"

using namespace palpate;
using namespace palpate::trajectories;

namespace {

/// A message of ROS 1, written by hand from its definition; a child frame makes it a transform.
std::vector<std::uint8_t> ros1_message(std::uint32_t second, const std::string& frame,
                                       const std::string& child) {
  std::vector<std::uint8_t> bytes;
  const auto put = [&](const auto value) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), begin, begin + sizeof value);
  };
  for (const std::uint32_t number : {0U, second, 1U}) put(number);
  const auto put_text = [&](const std::string& text) {
    put(std::uint32_t(text.size()));
    for (const char letter : text) put(letter);
  };
  put_text(frame);
  if (!child.empty()) put_text(child);
  for (const double x : {1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0}) put(x);
  return bytes;
}

/// What is said of a topic with these messages, "frame" or "frame>child" each.
std::string said_of_frames(const std::vector<std::string>& frames) {
  std::vector<std::string> warnings;
  const bool transforms = frames[0].find('>') != std::string::npos;
  StampedPoses poses(
      {.file = "a.bag"},
      {"/tf", transforms ? "geometry_msgs/TransformStamped" : "geometry_msgs/PoseStamped"},
      RosEncoding::kRos1, warnings);
  for (std::uint32_t i = 0; i < frames.size(); ++i) {
    const std::size_t end = std::min(frames[i].find('>'), frames[i].size());
    const std::string child = transforms ? frames[i].substr(end + 1) : "";
    poses.add(ros1_message(i + 1, frames[i].substr(0, end), child));
  }
  try {
    return std::to_string(std::move(poses).finish().size()) + " poses";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace

TEST_CASE("pose topics: motions of several frames in one topic are refused, with their names") {
  // Oracle: the stated rule and form.
  CHECK(said_of_frames({"world>tool", "/world>tool", "world>tool"}) == "3 poses");
  CHECK(said_of_frames({"world", "/world", "world"}) == "3 poses");
  CHECK(said_of_frames({"world>tool", "world>camera", "world>tool"}) ==
        "a.bag: topic '/tf' holds poses of several frames ('tool' in 'world', 'camera' in "
        "'world'), which are no single motion; write the one that is meant to a topic of its own");
  CHECK_THAT(said_of_frames({"world", "base", "world"}),
             Catch::Contains("several frames ('world', 'base'), which"));
  std::vector<std::string> many;
  for (int i = 0; i < 30; ++i) many.push_back("f" + std::to_string(i));
  CHECK_THAT(said_of_frames(many), Catch::Contains("'f9', …), which"));
}

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
