#include "haptics/devices/device.h"

#include <catch2/catch.hpp>

#include "haptics/devices/mouse_device.h"
#include "haptics/devices/topic_device.h"
#include "modules/core/error.h"
#include "tests/scratch_folder.h"

using namespace palpate;
using haptics::make_device;

TEST_CASE("make_device: builds the device the scene names") {
  // Oracle: the scene entries.
  std::vector<std::string> warnings;
  scene::ScriptedDevice script;
  script.start = Vec3(1, 0, 0);
  CHECK(make_device(script, {}, warnings)->read(0).pose.position == Vec3(1, 0, 0));
  scene::TopicDevice topic;
  topic.start = Vec3(0, 2, 0);
  topic.rotation = Quat(0, 1, 0, 0);
  const auto device = make_device(topic, {}, warnings);
  CHECK(dynamic_cast<haptics::TopicDevice*>(device.get()) != nullptr);
  CHECK(device->read(0).pose.position == Vec3(0, 2, 0));
  CHECK(device->read(0).pose.rotation.x() == 1);
  scene::MouseDevice mouse;
  mouse.start = Vec3(0, 0, 3);
  const auto follower = make_device(mouse, {}, warnings);
  CHECK(dynamic_cast<haptics::MouseDevice*>(follower.get()) != nullptr);
  CHECK(follower->read(0).pose.position == mouse.start);
  CHECK(warnings.empty());
}

TEST_CASE("make_device: a recording is placed in the world by its offset, twist included") {
  // Oracle: analytic. R is turned by a quarter about z and shifted: x of the recording is y of W.
  const ScratchFolder folder;
  const auto file = folder.write("line.csv",
                                 "t,x,y,z,qx,qy,qz,qw\n10,0,0,0,0,0,0,1\nbad\n11,0.1,0,0,0,0,0,1\n"
                                 "12,0.2,0,0,0,0,0,1\n13,0.3,0,0,0,0,0,1\n");
  scene::TrajectoryDevice config;
  config.file = file;
  config.offset = {Vec3(0, 0, 1), Quat(Eigen::AngleAxisd(1.5707963267948966, Vec3::UnitZ()))};
  std::vector<std::string> warnings;
  const auto device = make_device(config, {}, warnings);
  REQUIRE(warnings.size() == 4);  // the bad row, and three steps of 1 s are gaps
  CHECK(warnings[0].find("line.csv:3: left out") != std::string::npos);

  const haptics::DeviceSample sample = device->read(1.5);
  CHECK((sample.pose.position - Vec3(0, 0.15, 1)).norm() < 1e-15);
  CHECK((sample.twist.linear - Vec3(0, 0.1, 0)).norm() < 1e-15);
  CHECK(sample.pose.rotation.angularDistance(config.offset.rotation) < 1e-15);
  CHECK((device->read(100).pose.position - Vec3(0, 0.3, 1)).norm() < 1e-15);
  config.loop = true;
  const auto looped = make_device(config, {}, warnings);
  CHECK((looped->read(3 + 6.0).pose.position - Vec3(0, 0, 1)).norm() < 1e-15);
}

TEST_CASE("make_device: an unusable recording is refused") {
  // Oracle: the stated rule.
  std::vector<std::string> warnings;
  scene::TrajectoryDevice config;
  config.file = "/no/such/recording.csv";
  CHECK_THROWS_AS(make_device(config, {}, warnings), InputError);
}
