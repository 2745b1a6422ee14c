#include "haptics/devices/emulated_device.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>

#include "tests/haptics/critical_stiffness.h"
#include "tests/times.h"

using namespace palpate;
using haptics::DeviceSample;
using haptics::EmulatedDevice;

namespace {

scene::EmulatedDevice plain(double mass, double damping) {
  scene::EmulatedDevice config;
  config.mass = mass;
  config.damping = damping;
  config.encoder_step = 0;
  config.max_force = 1e6;
  return config;
}

RenderedForce force_of(const Vec3& force) {
  RenderedForce rendered;
  rendered.force = force;
  return rendered;
}

}  // namespace

TEST_CASE("emulated device: a constant push moves mass and damping as it must") {
  // Oracle: analytic, x = (f/b)(t − τ(1 − exp(−t/τ))), τ = m/b; its step is exact.
  auto config = plain(0.1, 0.2);
  config.start = Vec3(0.1, 0.2, 0.3);
  config.hand.push = Vec3(0, 0, -0.15);
  EmulatedDevice device(config);
  for (int i = 0; i <= 1000; ++i) {
    const double t = kTick * i, tau = 0.5;
    const double x = -0.15 / 0.2 * (t - tau * (1 - std::exp(-t / tau)));
    const Vec3 position = device.read(t).pose.position;
    REQUIRE((position - config.start - Vec3(0, 0, x)).norm() < 1e-12);
  }
}

TEST_CASE("emulated device: a hand's spring takes it to the hand's target, push included") {
  // Oracle: analytic, x = x_t + f/k at rest.
  auto config = plain(0.1, 0);
  config.hand.mass = 0.4;
  config.hand.damping = 5;
  config.hand.stiffness = 200;
  config.hand.push = Vec3(0, 1, 0);
  config.hand.moves = {{Vec3(0.01, 0, 0), 0.5}};
  EmulatedDevice device(config);
  DeviceSample sample;
  for (int i = 0; i <= 4000; ++i) sample = device.read(kTick * i);
  CHECK((sample.pose.position - Vec3(0.01, 1.0 / 200, 0)).norm() < 1e-9);
  CHECK(sample.twist.linear.norm() < 1e-9);
}

TEST_CASE(
    "emulated device: a spring without damping swings at its frequency and keeps its energy") {
  // Oracle: analytic, x = a cos ωt, ω = √(k/m), over 16 periods. Rounding grows with the cycles.
  auto config = plain(0.25, 0);
  config.hand.stiffness = 100;  // ω = 20/s
  config.hand.push = Vec3(1, 0, 0);
  EmulatedDevice device(config);
  for (int i = 0; i <= 5000; ++i) {
    const double x = device.read(kTick * i).pose.position.x();
    REQUIRE(std::abs(x - 0.01 * (1 - std::cos(20 * kTick * i))) < 1e-12);
  }
}

TEST_CASE("emulated device: on an axis it moves along it, by that part of what acts on it") {
  // Oracle: analytic, f t²/2m with f what the axis has of push and motor force.
  auto config = plain(0.1, 0);
  config.start = Vec3(1, 2, 3);
  config.axis = Vec3(0, 0.5, 0.5);
  config.hand.push = Vec3(3, 0.2, 0);
  EmulatedDevice device(config);
  device.read(0);
  device.feel(force_of(Vec3(-1, 0, -0.1)));
  const Vec3 moved = device.read(0.1).pose.position - config.start;
  CHECK((moved - Vec3(0, 0.05, 0.05) * 0.01 / 0.2).norm() < 1e-12);
}

TEST_CASE("emulated device: encoders give whole steps, and start on one") {
  // Oracle: definition.
  scene::EmulatedDevice config;
  config.start = Vec3(0.0123, 0, 0);
  config.encoder_step = 1e-4;
  config.hand.push = Vec3(0.05, 0.02, 0);
  EmulatedDevice device(config);
  CHECK(device.read(0).pose.position == config.start);
  for (int i = 1; i < 300; ++i) {
    const Vec3 steps = (device.read(kTick * i).pose.position - config.start) / 1e-4;
    REQUIRE((steps - steps.array().round().matrix()).norm() < 1e-9);
    REQUIRE((device.position() - config.start - 1e-4 * steps).cwiseAbs().maxCoeff() <= 0.51e-4);
  }
}

TEST_CASE("emulated device: motors give what they can and no more") {
  // Oracle: the two classes' peak forces.
  scene::EmulatedDevice config;
  CHECK(config.kind == scene::EmulatedDevice::Kind::kTouch);
  for (const double most : {3.3, 12.0}) {
    EmulatedDevice device(config);
    device.read(0);
    device.feel(force_of(Vec3(0, 0, 50)));
    device.read(kTick);
    CHECK(device.motor_force().norm() == Approx(most));
    config.kind = scene::EmulatedDevice::Kind::kOmega;
  }
}

TEST_CASE("emulated device: poses and forces are on their way for whole cycles") {
  // Oracle: counting. At 4 kHz, 1 ms is four cycles. A force felt at 10 ms moves the body from
  // 11 ms on; the reading that shows it leaves a cycle later and is seen 1 ms after that.
  auto config = plain(0.1, 0.2);
  config.rate = 4000;
  config.transport_delay = 1e-3;
  EmulatedDevice device(config);
  const auto at = [](int cycle) { return cycle / 4000.0; };
  for (int cycle = 0; cycle <= 60; ++cycle) {
    const double seen = device.read(at(cycle)).pose.position.x();
    if (cycle == 40) device.feel(force_of(Vec3(1, 0, 0)));
    CHECK((device.position().x() != 0) == (cycle > 44));
    CHECK((seen != 0) == (cycle > 48));
  }
}

TEST_CASE("emulated device: the same motion however often it is read, and again after a reset") {
  // Oracle: bit for bit.
  scene::EmulatedDevice config;
  config.hand.mass = 0.2;
  config.hand.damping = 2;
  config.hand.stiffness = 50;
  config.hand.moves = {{Vec3(0.02, 0.01, 0), 0.3}, {std::nullopt, 0.1}, {Vec3(0, 0, 0), 0.2}};
  EmulatedDevice often(config), seldom(config);
  Vec3 before;
  for (int run = 0; run < 2; ++run) {
    for (int i = 0; i <= 800; ++i) often.read(kTick * i);
    for (int i = 0; i <= 800; i += 50) seldom.read(kTick * i);
    CHECK(often.position() == seldom.position());
    if (run == 1) CHECK(often.position() == before);
    before = often.position();
    often.reset();
    seldom.reset();
    CHECK(often.read(0).pose.position == config.start);
  }
}

namespace {

/// Largest distance from rest in the last second of eight, after a kick of 10 mm/s, against a
/// spring of `stiffness` that the haptic loop at 1 kHz renders; over that in the third second.
double growth(const scene::EmulatedDevice& config, double stiffness) {
  auto kicked = config;
  kicked.hand.push = Vec3(0, 0, 0.01 * *config.mass / kTick);  // for one tick
  EmulatedDevice device(kicked);
  double early = 0, late = 0;
  for (int i = 0; i < 8000; ++i) {
    const double z = device.read(kTick * i).pose.position.z();
    const double kick = i > 0 ? kicked.hand.push.z() : 0;
    device.feel(force_of(Vec3(0, 0, -stiffness * z - kick)));
    if (i >= 2000 && i < 3000) early = std::max(early, std::abs(z));
    if (i >= 7000) late = std::max(late, std::abs(z));
    if (late > 10 || early > 10) return HUGE_VAL;
  }
  return late / early;
}

double rendered_border(const scene::EmulatedDevice& config) {
  return critical_stiffness(40'000,
                            [&](double stiffness) { return growth(config, stiffness) > 1; });
}

}  // namespace

TEST_CASE("emulated device: a rendered spring is stable to b/(T/2 + t_d)") {
  // Oracle: analytic (Colgate and Brown, ICRA 1994, without virtual damping); t_d both ways of
  // transport. Tolerance: −2 % for the bisection's 1 % and slow growth near the border; upwards
  // where ωT is not small the simulated loop is stable a little longer: ω²T²/… stays below 10 % as
  // long as K T² < 0.05 m.
  for (const double damping : {0.2, 2.0}) {
    for (const int cycles : {0, 1, 3}) {
      auto config = plain(damping > 1 ? 1.0 : 0.1, damping);
      config.transport_delay = cycles * kTick;
      const double formula = damping / (kTick / 2 + 2 * cycles * kTick);
      const double measured = rendered_border(config);
      std::cout << "emulated device, b = " << damping << ", t_d = " << 2 * cycles
                << " ms: critical stiffness by the formula " << formula << " N/m, measured "
                << measured << " N/m\n";
      CHECK(measured > 0.98 * formula);
      CHECK(measured < 1.1 * formula);
    }
  }
}
