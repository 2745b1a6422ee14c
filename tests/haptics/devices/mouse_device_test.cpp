#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "haptics/devices/mouse_device.h"
#include "modules/core/rotation_vector.h"
#include "tests/times.h"

using namespace palpate;
using haptics::DeviceSample;
using haptics::MouseDevice;

namespace {

Pose at(const Vec3& position, const Quat& rotation = Quat::Identity()) {
  return {position, rotation};
}

void command(MouseDevice& device, const Pose& pose, std::uint32_t buttons) {
  device.hear({pose, {}, buttons}, 0, 0);
}

}  // namespace

TEST_CASE("mouse device: follows a command as a critically damped second-order system") {
  // Oracle: analytic, e(t) = e₀ (1 + ωt) exp(−ωt), ω = 100/s, for a step small enough (5 mm) not
  // to meet the speed limit. Tolerance: the wanted velocity is held for a tick of 1 ms, ωT/2 = 5 %
  // of the step.
  MouseDevice device({});
  device.read(0);
  command(device, at(Vec3(0.005, 0, 0)), 0);
  double furthest = 0;
  for (int i = 1; i <= 200; ++i) {
    const double x = device.read(kTick * i).pose.position.x();
    const double wt = 100 * kTick * i;
    CHECK(std::abs(x - 0.005 * (1 - (1 + wt) * std::exp(-wt))) < 0.05 * 0.005);
    furthest = std::max(furthest, x);
  }
  CHECK(furthest < 0.005 * 1.001);
  CHECK(device.read(0.2).pose.position.x() == Approx(0.005).epsilon(1e-3));
}

TEST_CASE("mouse device: a jump of ten metres is travelled at the stated speed, never teleported") {
  // Oracle: invariant |v| ≤ 0.5 m/s, and the time the way takes at that speed. Tolerance: a
  // position near 10 m is rounded by 2e-15 m, 4e-12 of the way of a tick.
  MouseDevice device({});
  device.read(0);
  command(device, at(Vec3(6, -8, 0)), 0);
  Vec3 last = Vec3::Zero();
  double arrival = 0;
  for (int i = 1; i <= 21000; ++i) {
    const DeviceSample sample = device.read(kTick * i);
    REQUIRE((sample.pose.position - last).norm() <= MouseDevice::kMaxSpeed * kTick * (1 + 1e-11));
    REQUIRE(sample.twist.linear.norm() <= MouseDevice::kMaxSpeed * (1 + 1e-12));
    last = sample.pose.position;
    if (arrival == 0 && (last - Vec3(6, -8, 0)).norm() < 1e-3) arrival = kTick * i;
  }
  // 20 s for the way, and some 1/k = 20 ms for the start and the approach.
  CHECK(arrival > 20);
  CHECK(arrival < 20.15);
  CHECK((last - Vec3(6, -8, 0)).norm() < 1e-12);
}

TEST_CASE("mouse device: a steady motion is followed with the stated delay") {
  // Oracle: analytic, ramp delay 1/k = 20 ms; commands every 16th tick add a sawtooth of mean
  // 7.5 ms; a command counts for the whole tick at whose end it is read, 1 ms less.
  MouseDevice device({});
  const double speed = 0.1;
  double delay = 0;
  int count = 0;
  for (int i = 0; i <= 2000; ++i) {
    if (i % 16 == 0) command(device, at(Vec3(speed * kTick * i, 0, 0)), 0);
    const double x = device.read(kTick * i).pose.position.x();
    if (i > 400) delay += kTick * i - x / speed, ++count;
  }
  CHECK(delay / count == Approx(MouseDevice::kRampDelay + 0.0065).epsilon(0.01));
}

TEST_CASE("mouse device: rotations are followed the short way round and never too fast") {
  // Oracle: invariants. A quarter turn commanded as −q. It may be overshot by what holding the
  // wanted speed for a tick does to critical damping: 1e-6 of the way.
  const Quat quarter = rotation_from_vector(Vec3(0, 0, 1.5707963267948966));
  Quat commanded = quarter;
  commanded.coeffs() *= -1;
  MouseDevice device({});
  device.read(0);
  command(device, at(Vec3::Zero(), commanded), 0);
  Quat last = Quat::Identity();
  for (int i = 1; i <= 1000; ++i) {
    const DeviceSample sample = device.read(kTick * i);
    const Vec3 turn = vector_from_rotation(sample.pose.rotation * last.conjugate());
    REQUIRE(turn.norm() <= MouseDevice::kMaxTurn * kTick * (1 + 1e-9));
    REQUIRE(turn.z() >= -1e-6);
    REQUIRE(std::abs(sample.pose.rotation.norm() - 1) < 1e-14);
    last = sample.pose.rotation;
  }
  CHECK(vector_from_rotation(last.conjugate() * quarter).norm() < 1e-9);
}

TEST_CASE("mouse device: the twist is what moves the pose") {
  // Oracle: invariant. Within a tick the velocity goes straight from the old to the new twist, so
  // the mean, moved/T, lies between the two.
  MouseDevice device({});
  DeviceSample last = device.read(0);
  command(device, at(Vec3(0.1, 0.05, 0)), 0);
  for (int i = 1; i <= 500; ++i) {
    const DeviceSample sample = device.read(kTick * i);
    const Vec3 mean = (sample.pose.position - last.pose.position) / kTick;
    const double change = (sample.twist.linear - last.twist.linear).norm();
    REQUIRE((mean - last.twist.linear).norm() <= change + 1e-12);
    REQUIRE((mean - sample.twist.linear).norm() <= change + 1e-12);
    last = sample;
  }
}

TEST_CASE("mouse device: commands that are no pose are refused, buttons and all") {
  // Oracle: invariant, the pose stays bit for bit; the refusal is said once.
  scene::MouseDevice config;
  config.start = Vec3(0.1, 0.2, 0.3);
  MouseDevice device(config);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Pose& bad : {at(Vec3(nan, 0, 0)), at(Vec3(0, HUGE_VAL, 0)), at(Vec3(1e308, 0, 0)),
                          at(Vec3::Zero(), Quat(0, 0, 0, 0)), at(Vec3::Zero(), Quat(2, 0, 0, 0)),
                          at(Vec3::Zero(), Quat(nan, 0, 0, 0))}) {
    command(device, bad, 7);
  }
  const DeviceSample sample = device.read(1);
  CHECK(sample.pose.position == config.start);
  CHECK(sample.twist.linear.norm() == 0);
  CHECK(sample.buttons == 0);
  CHECK(sample.limits == kPoseRefused);
  command(device, at(config.start), 5);
  CHECK(device.read(1.001).buttons == 5);
  CHECK(device.read(1.002).limits == kForceNotLimited);
}

TEST_CASE("mouse device: pauses in reading, a clock set back and NaN times move nothing far") {
  // Oracle: invariant, at most kMaxSpeed · kLongestStep per read.
  MouseDevice device({});
  device.read(0);
  command(device, at(Vec3(1, 0, 0)), 0);
  Vec3 last = device.read(kTick).pose.position;
  for (const double t :
       {100.0, 0.0, 0.001, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, 0.002, 1e300, 5.0}) {
    const Vec3 now = device.read(t).pose.position;
    REQUIRE(now.allFinite());
    CHECK((now - last).norm() <= MouseDevice::kMaxSpeed * MouseDevice::kLongestStep * (1 + 1e-12));
    last = now;
  }
}
