#include "haptics/devices/yielding_device.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "haptics/devices/scripted_device.h"
#include "tests/times.h"

using namespace palpate;
using namespace palpate::haptics;

namespace {

scene::ScriptedDevice forth_and_back() {
  scene::ScriptedDevice script;
  script.start = Vec3(0, -0.1, 0);
  script.moves = {{Vec3(0, 0, 0), 2}, {Vec3(0, -0.1, 0), 2}, {Vec3(0, 0, 0), 5}};
  return script;
}

YieldingDevice yielding() {
  return YieldingDevice(std::make_unique<ScriptedDevice>(forth_and_back()));
}

DeviceSample sampled_at(const Vec3& place) {
  DeviceSample said;
  said.pose.position = place;
  return said;
}

/// Reads a second or so in ticks, held at `place` where that is given. @returns the longest step
double play(YieldingDevice& device, double& time, double duration, const Vec3* place = nullptr) {
  double longest = 0;
  Vec3 before = device.read(time).pose.position;
  for (const double end = time + duration; time < end; time += kTick) {
    if (place != nullptr) device.hear(sampled_at(*place), 0, 0);
    const Vec3 now = device.read(time).pose.position;
    longest = std::max(longest, (now - before).norm());
    before = now;
  }
  return longest;
}

}  // namespace

TEST_CASE("yielding device: untouched it is the script, to the bit") {
  // Oracle: the scripted device.
  YieldingDevice device = yielding();
  ScriptedDevice script(forth_and_back());
  for (double time = 0; time < 9; time += 0.0137) {
    const DeviceSample a = device.read(time), b = script.read(time);
    CHECK(a.pose.position == b.pose.position);
    CHECK(a.twist.linear == b.twist.linear);
    CHECK(a.limits == b.limits);
  }
}

TEST_CASE("yielding device: taken over it goes where it is told, never faster than a mouse") {
  // Oracle: the mouse's speed; the place told.
  YieldingDevice device = yielding();
  double time = 0;
  play(device, time, 1);
  const Vec3 place(0.05, -0.03, 0.02);
  CHECK(play(device, time, 1, &place) <= MouseDevice::kMaxSpeed * kTick * (1 + 1e-9));
  CHECK((device.read(time).pose.position - place).norm() < 1e-6);
}

TEST_CASE(
    "yielding device: silence gives it back, without a jump, to where the script is by then") {
  // Oracle: the scripted device at the same time; the longest step is a mouse's, or its own plus
  // what kBackWithin allows.
  YieldingDevice device = yielding();
  ScriptedDevice script(forth_and_back());
  double time = 0;
  play(device, time, 1);
  const Vec3 place(0.05, -0.03, 0.02);
  play(device, time, 1, &place);
  const double longest = play(device, time, YieldingDevice::kGivenBackAfter - 0.01);
  CHECK(longest < 1e-6);  // it waits where it was left
  CHECK(play(device, time, 1.9) <= MouseDevice::kMaxSpeed * kTick + YieldingDevice::kBackWithin);
  for (int i = 0; i < 100; ++i, time += kTick) {
    CHECK(device.read(time).pose.position == script.read(time).pose.position);
  }
}

TEST_CASE(
    "yielding device: a pose that is not believable takes nothing over, nor does a stray sample",
    "[fault]") {
  // Oracle: the scripted device.
  YieldingDevice device = yielding();
  ScriptedDevice script(forth_and_back());
  device.read(0.5);
  device.hear(sampled_at(Vec3(std::nan(""), 0, 0)), 0, 0);
  device.refuse();
  CHECK(device.read(0.6).pose.position == script.read(0.6).pose.position);
  CHECK(device.read(0.7).limits == kForceNotLimited);
}

TEST_CASE("yielding device: a reset gives it back at once") {
  // Oracle: the script's start.
  YieldingDevice device = yielding();
  double time = 0;
  const Vec3 place(0.05, -0.03, 0.02);
  play(device, time, 0.5, &place);
  device.reset();
  CHECK(device.read(0).pose.position == forth_and_back().start);
}
