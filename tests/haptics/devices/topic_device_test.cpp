#include "haptics/devices/topic_device.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "modules/core/rotation_vector.h"
#include "tests/times.h"

using namespace palpate;
using haptics::DeviceSample;
using haptics::TopicDevice;

namespace {

/// A device with its driver, whose clock is the host's.
struct Driven {
  TopicDevice device{{}, {}};

  /// The driver samples at `at` [ms]; heard at once unless said.
  void say(std::int64_t at, const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
    say(at, {{position, Quat::Identity()}, {velocity, Vec3::Zero()}, 0});
  }
  void say(std::int64_t at, const DeviceSample& sample) {
    device.hear(sample, (kBegin + at) * kMs, (kBegin + at) * kMs);
  }
  DeviceSample read(std::int64_t at) { return device.read(1e-3 * double(kBegin + at)); }

  static constexpr std::int64_t kBegin = 5000;  ///< [ms]
};

/// Times of some thousand seconds are doubles within 1e-12 s.
constexpr double kRounding = 1e-11;

}  // namespace

TEST_CASE("topic device: gives the driver's pose as it comes, in the tick in which it comes") {
  // Oracle: the samples. A hand at 1 m/s in millimetre steps, a pose that does not say its speed:
  // nothing behind, nothing smoothed, nothing reported.
  Driven driven;
  for (std::int64_t i = 1; i <= 100; ++i) {
    driven.say(i, Vec3(1e-3 * double(i), 0, 0));
    const DeviceSample sample = driven.read(i);
    REQUIRE(sample.pose.position == Vec3(1e-3 * double(i), 0, 0));
    REQUIRE(sample.limits == kForceNotLimited);
    REQUIRE(sample.silence < kRounding);
  }
}

TEST_CASE("topic device: a pose is carried to the tick by its twist, for 10 ms and no longer") {
  // Oracle: analytic, x = v t and a turn of ω t; beyond 10 ms it rests.
  Driven driven;
  DeviceSample said;
  said.twist = {Vec3(0.3, 0, 0), Vec3(0, 0, 2)};
  driven.say(0, said);
  for (std::int64_t i = 0; i <= 40; ++i) {
    const DeviceSample sample = driven.read(i);
    const double carried = std::min(1e-3 * double(i), 0.01);
    CHECK((sample.pose.position - Vec3(0.3 * carried, 0, 0)).norm() < kRounding);
    CHECK((vector_from_rotation(sample.pose.rotation) - Vec3(0, 0, 2 * carried)).norm() <
          kRounding);
    if (i != 10) CHECK(sample.twist.linear.x() == (i < 10 ? 0.3 : 0));
    CHECK(sample.silence == Approx(1e-3 * double(i)).margin(kRounding));
  }
}

TEST_CASE("topic device: a driver at 50 Hz that says its speed is followed at every tick") {
  // Oracle: analytic. x = 0.1 sin(2π t), samples 20 ms apart: carried for 10 ms, ½ a (10 ms)² =
  // 0.2 mm off; then resting for 10 ms at 0.63 m/s at most, 6.3 mm.
  Driven driven;
  const double w = 2 * 3.14159265358979;
  double worst_carried = 0, worst = 0;
  for (std::int64_t i = 0; i < 2000; ++i) {
    const double t = 1e-3 * double(i);
    if (i % 20 == 0)
      driven.say(i, Vec3(0.1 * std::sin(w * t), 0, 0), Vec3(0.1 * w * std::cos(w * t), 0, 0));
    const DeviceSample sample = driven.read(i);
    const double error = std::abs(sample.pose.position.x() - 0.1 * std::sin(w * t));
    REQUIRE(sample.limits == kForceNotLimited);
    worst = std::max(worst, error);
    if (i % 20 <= 10) worst_carried = std::max(worst_carried, error);
  }
  CHECK(worst_carried < 0.5 * 0.1 * w * w * 1e-4 * 1.01);
  CHECK(worst < 0.1 * w * 0.01 + 0.5 * 0.1 * w * w * 4e-4);
}

TEST_CASE("topic device: a jump is travelled at 2 m/s and 20 rad/s, and said until it is over") {
  // Oracle: invariant |v| ≤ 2 m/s, and the time of the way: 19 mm in 10 ticks, 0.15 rad in 8.
  Driven driven;
  driven.say(0, Vec3::Zero());
  driven.read(0);
  DeviceSample far;
  far.pose = {Vec3(0.0114, -0.0152, 0), rotation_from_vector(Vec3(0, 0.15, 0))};
  Vec3 last = Vec3::Zero();
  for (std::int64_t i = 1; i <= 20; ++i) {
    driven.say(i, far);
    const DeviceSample sample = driven.read(i);
    REQUIRE((sample.pose.position - last).norm() <= 2 * kTick + kRounding);
    REQUIRE(((sample.limits & kPoseSlewed) != 0) == (i < 10));
    REQUIRE(sample.silence < kRounding);
    if (i < 10) CHECK(sample.twist.linear.norm() == Approx(2).epsilon(1e-6));
    if (i < 8) {
      CHECK(vector_from_rotation(sample.pose.rotation).norm() == Approx(0.02 * double(i)));
    }
    last = sample.pose.position;
  }
  CHECK(last == far.pose.position);
}

TEST_CASE("topic device: what no hand does is no motion: it is taken as it is, the force let go") {
  // Oracle: the stated rule. Jumps of more than 20 mm or 0.2 rad beyond what 2 m/s and 20 rad/s
  // allow: silent until the force is gone, 0.1 s, for one tick each; after the last one nothing.
  Driven driven;
  driven.say(0, Vec3::Zero());
  driven.read(0);
  DeviceSample turned;
  turned.pose = {Vec3(0.1, 0, 0), rotation_from_vector(Vec3(0.25, 0, 0))};
  std::int64_t at = 0;
  for (const Vec3& far : {Vec3(1000, 0, 0), Vec3(0.121, 0, 0), Vec3(0.1, 0, 0)}) {
    driven.say(++at, far);
    const DeviceSample sample = driven.read(at);
    const bool jumps = far != Vec3(0.1, 0, 0) || at != 3;
    CHECK(sample.pose.position.x() == Approx(far.x() + (jumps ? 0 : 0.019)));
    CHECK(sample.limits == kPoseSlewed);
    CHECK(sample.silence == Approx(jumps ? 0.1 : 0).margin(kRounding));
  }
  for (int i = 0; i < 20; ++i) {
    driven.say(++at, Vec3(0.1, 0, 0));
    driven.read(at);
  }
  driven.say(++at, turned);
  CHECK(driven.read(at).silence == Approx(0.1));
  driven.say(++at, turned);
  const DeviceSample after = driven.read(at);
  CHECK(after.limits == kForceNotLimited);
  CHECK(after.silence < kRounding);
  CHECK(after.twist.linear.isZero(0));
}

TEST_CASE("topic device: two drivers far from each other have no force, however long they talk") {
  // Oracle: invariant, it is silent in each tick in which the other one spoke.
  Driven driven;
  driven.say(0, Vec3::Zero());
  driven.read(0);
  for (std::int64_t i = 1; i <= 100; ++i) {
    driven.say(i, Vec3(i % 2 == 0 ? 0 : 0.05, 0, 0));
    REQUIRE(driven.read(i).silence == Approx(0.1));
  }
}

TEST_CASE("topic device: of a driver that says no velocity its poses tell it, and carry nothing") {
  // Oracle: analytic, a hand at 0.3 m/s and 2 rad/s, sampled each millisecond or each ten.
  for (const std::int64_t apart : {1, 10}) {
    Driven driven;
    for (std::int64_t i = 0; i <= 40; ++i) {
      DeviceSample said;
      said.pose = {Vec3(3e-4 * double(i), 0, 0),
                   rotation_from_vector(Vec3(0, 2e-3 * double(i), 0))};
      if (i % apart == 0) driven.say(i, said);
      const DeviceSample sample = driven.read(i);
      const std::int64_t heard = i - i % apart;
      CHECK(sample.pose.position.x() == Approx(3e-4 * double(heard)));
      if (i >= 2 * apart && i % apart < 9) {
        CHECK(sample.twist.linear.x() == Approx(0.3).epsilon(1e-6));
        CHECK(sample.twist.angular.y() == Approx(2).epsilon(1e-6));
      }
    }
    CHECK(driven.read(51).twist.linear.isZero(0));  // it rests
  }
}

TEST_CASE("topic device: a speed that no hand has is neither believed nor carried") {
  // Oracle: a driver that writes millimetres per second: 500 "m/s" count as 2.
  Driven driven;
  driven.say(0, Vec3::Zero(), Vec3(500, 0, 0));
  const DeviceSample sample = driven.read(5);
  CHECK(sample.pose.position.x() == Approx(2 * 0.005).epsilon(1e-6));
  CHECK(sample.limits == kPoseSlewed);
  CHECK(driven.read(6).limits == kPoseSlewed);  // as long as it holds
}

TEST_CASE(
    "topic device: what is no pose, no twist or old is refused, said once, and the rest holds") {
  // Oracle: invariant, the pose stays bit for bit.
  Driven driven;
  const Vec3 here(0.1, 0.2, 0.3);
  driven.say(0, here);
  driven.read(0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<DeviceSample> bad(7);
  bad[0].pose.position.x() = nan;
  bad[1].pose.position.y() = HUGE_VAL;
  bad[2].pose.position.z() = 1e308;
  bad[3].pose.rotation = Quat(0, 0, 0, 0);
  bad[4].pose.rotation = Quat(2, 0, 0, 0);
  bad[5].twist.linear.x() = nan;
  bad[6].twist.angular.x() = HUGE_VAL;
  std::int64_t at = 0;
  for (DeviceSample& sample : bad) {
    sample.buttons = 7;
    driven.say(++at, sample);
    const DeviceSample now = driven.read(at);
    CHECK(now.limits == kPoseRefused);
    CHECK(now.pose.position == here);
    CHECK(now.buttons == 0);
    CHECK(driven.read(at).limits == kForceNotLimited);
  }
  driven.device.hear({{Vec3::Zero(), Quat::Identity()}, {}, 0}, (Driven::kBegin - 1) * kMs,
                     (Driven::kBegin + at) * kMs);
  const DeviceSample now = driven.read(at);
  CHECK(now.limits == kPoseRefused);
  CHECK(now.pose.position == here);
}

TEST_CASE("topic device: silent at its start until it is first heard, then at its driver's pose") {
  // Oracle: the stated rule: it enters where it is, not slewed from the start.
  scene::TopicDevice config;
  config.start = Vec3(0, 0, 0.5);
  TopicDevice device(config, {});
  CHECK(std::isinf(device.read(1).silence));
  CHECK(device.read(1).pose.position == config.start);
  CHECK(device.read(1).twist.linear.norm() == 0);
  device.hear({{Vec3(1, 2, 3), Quat::Identity()}, {}, 5}, 0, 1001 * kMs);
  const DeviceSample sample = device.read(1.001);
  CHECK(sample.pose.position == Vec3(1, 2, 3));
  CHECK(sample.limits == kForceNotLimited);
  CHECK(sample.silence == 0);
  CHECK(sample.buttons == 5);
}

TEST_CASE("topic device: after a silence that let the force go it returns where it is") {
  // Oracle: the stated rule, 0.1 s; before that a jump lets the force go. The clock may be another.
  for (const bool gone : {false, true}) {
    Driven driven;
    driven.say(0, Vec3::Zero());
    driven.read(0);
    const std::int64_t back = gone ? 101 : 99;
    driven.read(back - 1);
    driven.device.hear({{Vec3(0.5, 0, 0), Quat::Identity()}, {}, 0}, 17,
                       (Driven::kBegin + back) * kMs);
    const DeviceSample sample = driven.read(back);
    CHECK(sample.pose.position == Vec3(0.5, 0, 0));
    CHECK(sample.silence == Approx(gone ? 0 : 0.1).margin(kRounding));
    CHECK(sample.limits == (gone ? kForceNotLimited : kPoseSlewed));
  }
}

TEST_CASE("topic device: times that are no numbers or go back move nothing") {
  // Oracle: invariant, the pose that was said.
  Driven driven;
  driven.say(0, Vec3(0.1, 0, 0), Vec3(0.1, 0, 0));
  for (const double t : {5.0, std::nan(""), HUGE_VAL, -1e300, 4.0, 5.0}) {
    CHECK(driven.device.read(t).pose.position == Vec3(0.1, 0, 0));
  }
}
