// What bounds, fades and refuses on the way from the law to the device.
#include "haptics/haptic_renderer.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>
#include <limits>

#include "tests/haptics/renderer_bench.h"

using namespace palpate;
using namespace palpate::haptics;
using namespace palpate::testing;

TEST_CASE("haptic renderer: a stale model fades linearly to zero in the stated time") {
  // Oracle: analytic, factor 1 − (age − stale_after)/fade_time. Rounding of times: 1e-12.
  RendererBench bench;
  bench.hold(wall_model(kPressed), resting_at(kPressed), 37);
  const double last_model = 36 * kT;
  while (bench.time() < last_model + 0.12) {
    const double age = bench.time() - last_model;
    const RenderedForce out = bench.tick(resting_at(kPressed));
    const double factor = std::min(1.0, std::max(0.0, 1 - (age - 0.05) / 0.05));
    CHECK(out.force.z() == Approx(2 * factor).margin(1e-12));
    CHECK(out.torque.norm() == Approx(0.02 * factor).margin(1e-12));
    CHECK(((out.limits & kForceStaleFade) != 0) == (factor < 1));
  }
  CHECK(bench.tick(resting_at(kPressed)).force.norm() == 0);

  // Fresh again: back up, no faster than the slew limit.
  double before = 0;
  LocalLaw every_tick = wall_model(kPressed);
  every_tick.period = kT;
  for (int i = 0; i < 40; ++i) {
    const RenderedForce out = bench.hold(every_tick, resting_at(kPressed), 1);
    CHECK(out.force.z() - before <= 0.2 + 1e-12);
    CHECK(out.force.z() >= before);
    before = out.force.z();
  }
  CHECK(before == 2);
}

TEST_CASE("haptic renderer: a hand that gives way as a stale model fades is let go all the same") {
  // Oracle: the stated times, whatever the hand does: here it is pushed out while the force fades,
  // then swings with 20 mm/s. Slew: 2 N go within 10 ticks.
  RendererBench bench;
  bench.hold(wall_model(kPressed), resting_at(kPressed), 400);
  const double fresh = bench.time();  // the last model is 4 ticks old at most
  DeviceSample device = resting_at(kPressed);
  double last = 0;
  for (int i = 0; i < 300; ++i) {
    device.twist.linear.z() = i < 60 ? 0 : 0.02 * std::cos(0.05 * (i - 60));
    device.pose.position.z() += kT * device.twist.linear.z();
    const double now = bench.time();
    if (bench.tick(device).force.norm() > 0) last = now;
  }
  const scene::Haptics limits;
  INFO("let go " << last - fresh << " s after the last model");
  CHECK(last - fresh <= limits.stale_after + limits.fade_time + 10 * kT);
}

TEST_CASE("haptic renderer: a hand in debt that is near nothing any more is let go all the same") {
  // Oracle: the stated time and the slew limit, 2 N in 10 ticks. As when collision dies: laws go on
  // coming, without rows. The hand was pushed out, faster than it went in, and swings on.
  RendererBench bench;
  DeviceSample device = resting_at(kPressed);
  bench.hold(wall_model(kPressed), device, 40);
  for (int i = 0; i < 40; ++i) {  // a law that pushes harder and harder gives energy
    device.twist.linear.z() = 0.05;
    device.pose.position.z() += kT * 0.05;
    bench.hold(wall_model(device.pose.position), device, 1);
  }
  LocalLaw nothing = wall_model(device.pose.position);
  nothing.rows.clear();
  nothing.compliance.clear();
  nothing.stiffness.setZero();
  const double since = bench.time();
  double last = since;
  for (int i = 0; i < 400; ++i) {
    device.twist.linear.z() = 0.05 * std::cos(0.02 * i);
    device.pose.position.z() += kT * device.twist.linear.z();
    const double now = bench.time();
    const RenderedForce out = bench.hold(nothing, device, 1);
    if (out.force.norm() > 0) last = now;
  }
  INFO("let go " << last - since << " s after the last law with rows");
  CHECK(last - since <= HeldLaw::kLetGo + 10 * kT);
}

TEST_CASE("haptic renderer: where the slew limit is slower than the fade, it decides") {
  // Oracle: analytic. 10 N/s: 2 N take 200 ms however short the fade.
  scene::Haptics limits;
  limits.max_force_rate = 10;
  RendererBench bench(limits);
  bench.hold(wall_model(kPressed), resting_at(kPressed), 401);
  const double last_model = 400 * kT;
  while (bench.time() < last_model + 0.2) bench.tick(resting_at(kPressed));
  CHECK(bench.tick(resting_at(kPressed)).force.z() > 0.4);
  while (bench.time() < last_model + 0.05 + 0.2 + 0.01) bench.tick(resting_at(kPressed));
  CHECK(bench.tick(resting_at(kPressed)).force.norm() == 0);
}

TEST_CASE("haptic renderer: a lost contact is let go within the hand-over and the slew limit") {
  // Oracle: analytic. 2 N at 0.2 N per tick: ten ticks; never less than nothing.
  RendererBench bench;
  bench.hold(wall_model(kPressed), resting_at(kPressed), 40);
  bench.renderer.update_law(wall_model(Vec3(0, 0, 0.01)), bench.time());
  for (int i = 1; i <= 10; ++i) {
    CHECK(bench.tick(resting_at(kPressed)).force.z() >= 2 - 0.2 * i - 1e-12);
  }
  const RenderedForce out = bench.tick(resting_at(kPressed));
  CHECK(out.force.norm() < 1e-12);
  CHECK(bench.tick(resting_at(kPressed)).passivity_energy == 0);
}

TEST_CASE("haptic renderer: steps stay under 0.05 N while pressing a curved contact at 40 mm/s") {
  // Oracle: felt threshold, 5 % of the force or 0.05 N, and a Hertz contact (E* 13.3 kPa, R 5 mm)
  // whose models are one update old when they arrive.
  const int update_ticks = GENERATE(4, 25);
  RendererBench bench;
  const double c = 4.0 / 3 * 13.3e3 * std::sqrt(0.005);
  const auto hertz = [&](double depth) {
    LocalLaw model = wall_model(Vec3(0, 0, -depth));
    model.period = kT * update_ticks;
    const double d = std::max(0.0, depth);
    model.rows[0].force.z() = c * std::pow(d, 1.5);
    model.compliance[0] = 1 / std::max(1e-3, 1.5 * c * std::sqrt(d));
    return model;
  };
  const double speed = 0.04;
  const auto depth_at = [&](double t) {  // down 10 mm, then up again, turning smoothly
    return 0.005 - 0.005 * std::cos(2 * speed / 0.01 * t);
  };
  double worst_step = 0, worst_error = 0, last = 0;
  for (int i = 0; i < 1500; ++i) {
    if (i % update_ticks == 0) {
      bench.renderer.update_law(hertz(depth_at(bench.time() - kT * update_ticks)), bench.time());
    }
    const double depth = depth_at(bench.time());
    DeviceSample sample = resting_at(Vec3(0, 0, -depth));
    sample.twist.linear.z() =
        -(depth_at(bench.time() + kT / 2) - depth_at(bench.time() - kT / 2)) / kT;
    const double force = bench.tick(sample).force.z();
    const double step = std::abs(force - last);
    if (step > 0.05 * std::max(force, last)) worst_step = std::max(worst_step, step);
    worst_error = std::max(worst_error, std::abs(force - c * std::pow(depth, 1.5)));
    last = force;
  }
  std::cout << "pressing at 40 mm/s, a model every " << update_ticks
            << " ms: largest step over 5 % " << worst_step << " N, largest error " << worst_error
            << " N\n";
  CHECK(worst_step < 0.05);
  // A tangent is at most 2·25 ms · 40 mm/s = 2 mm away: ½ f″ (2 mm)², f″ = ¾ c/√d, is 0.027 N at
  // 5 mm depth, where the motion is fastest; near the surface it slows down.
  CHECK(worst_error < 0.05);
}

TEST_CASE("haptic renderer: force and torque are cut together") {
  // Oracle: analytic. 6.6 N wanted, 3.3 N given: half the torque.
  RendererBench bench;
  LocalLaw model = wall_model(Vec3(0, 0, -0.033));
  const RenderedForce out = bench.hold(model, resting_at(model.anchor.position), 60);
  CHECK(out.force.z() == Approx(3.3).epsilon(1e-12));
  CHECK((out.limits & kForceSaturated) != 0);
  CHECK((out.torque - 0.5 * model.torque()).norm() < 1e-14);
  model.rows[0].point_P = Vec3(0, 100, 0);
  CHECK(bench.hold(model, resting_at(model.anchor.position), 200).torque.norm() ==
        Approx(3.3 * HapticRenderer::kTorqueArm).epsilon(1e-12));
}

TEST_CASE("haptic renderer: outside the validity radius is said, and the force goes no further") {
  // Oracle: analytic. 12 mm deeper counts as 4 mm: 2 N + 0.8 N.
  RendererBench bench;
  LocalLaw model = wall_model(kPressed);
  model.validity_radius = 0.004;
  const RenderedForce out = bench.hold(model, resting_at(kPressed - Vec3(0, 0, 0.012)), 60);
  CHECK((out.limits & kForceOutOfValidity) != 0);
  CHECK(out.force.z() == Approx(2.8));
}

TEST_CASE("haptic renderer: a silent driver's force fades, and rises as slowly when it returns") {
  // Oracle: analytic, factor 1 − (silence − stale_after)/fade_time down, one tick's share of
  // fade_time up; the law is fresh throughout. Also where the probe has jumped meanwhile.
  RendererBench bench;
  bench.hold(wall_model(kPressed), resting_at(kPressed), 40);
  DeviceSample silent = resting_at(kPressed);
  for (int i = 1; i <= 110; ++i) {
    silent.silence = kT * i;
    const RenderedForce out = bench.hold(wall_model(kPressed), silent, 1);
    const double factor = std::clamp(1 - (kT * i - 0.05) / 0.05, 0.0, 1.0);
    CHECK(out.force.z() == Approx(2 * factor).margin(1e-12));
    CHECK(out.torque.norm() == Approx(0.02 * factor).margin(1e-12));
    CHECK(((out.limits & kDriverSilent) != 0) == (factor < 1));
  }
  const Vec3 elsewhere = kPressed + Vec3(0.5, 0, 0);
  for (int i = 1; i <= 60; ++i) {
    const RenderedForce out = bench.hold(wall_model(elsewhere), resting_at(elsewhere), 1);
    // The passivity controller may take something away from a force that nobody pressed for; the
    // hand rests, so it does not.
    CHECK(out.force.z() == Approx(2 * std::min(1.0, 0.02 * i)).margin(1e-9));
  }
}

TEST_CASE("haptic renderer: of what is stiffer than the device can hold the change is capped") {
  // Oracle: analytic. b 0.2 N·s/m, T 1 ms, t_d 2 ms hold 0.2/(T/2 + t_d) = 80 N/m; of a wall of
  // 200 N/m that gives 2 N where the law was made, 1 mm is then felt as 0.08 N. Without delay 400
  // N/m are held. A law that says of no row that it presses keeps the cap of the one before.
  RendererBench bench;
  REQUIRE(scene::Haptics{}.device_damping == 0.2);
  DeviceSample held = resting_at(kPressed), deeper = resting_at(kPressed - Vec3(0, 0, 1e-3));
  held.delay = deeper.delay = 0.002;
  const RenderedForce capped = bench.hold(wall_model(kPressed), held, 40);
  CHECK(capped.force.z() == Approx(2).epsilon(1e-9));
  CHECK(capped.limits == kStiffnessCapped);
  CHECK(bench.hold(wall_model(kPressed), deeper, 40).force.z() == Approx(2.08).epsilon(1e-9));
  LocalLaw open = wall_model(kPressed);
  open.stiffness.setZero();
  CHECK(bench.hold(open, deeper, 40).force.z() == Approx(2.08).epsilon(1e-9));
  held.delay = deeper.delay = 0;
  CHECK(bench.hold(wall_model(kPressed), deeper, 40).force.z() == Approx(2.2).epsilon(1e-9));
  CHECK(bench.hold(wall_model(kPressed), held, 40).limits == kForceNotLimited);
}

TEST_CASE("haptic renderer: a held device is damped in contact, by 0.3 of the force at most") {
  // Oracle: analytic, 1 N·s/m: at 10 mm/s inwards 2 N and 10 mN; at 20 m/s 0.3 N more;
  // across the force, or where nobody holds the device, nothing.
  RendererBench bench;
  const LocalLaw model = wall_model(kPressed);
  DeviceSample held = resting_at(kPressed);
  held.delay = 0;
  bench.hold(model, held, 40);
  const auto at_speed = [&](const Vec3& velocity) {
    DeviceSample moving = held;
    moving.twist.linear = velocity;
    return bench.tick(moving).force.z();
  };
  CHECK(at_speed(Vec3(0, 0, -0.01)) == Approx(2.01));
  CHECK(at_speed(Vec3(0.01, 0, 0)) == Approx(2));
  held.delay.reset();
  CHECK(at_speed(Vec3(0, 0, -0.01)) == Approx(2));
  scene::Haptics fast;
  fast.max_force_rate = 1e5;
  RendererBench unslewed(fast);
  held.delay = 0;
  unslewed.hold(wall_model(kPressed, 100), held, 400);
  held.twist.linear.z() = -20;
  CHECK(unslewed.tick(held).force.z() == Approx(1 + 0.3));
}

TEST_CASE("haptic renderer: a device that gives NaN gets a force going to zero, said so") {
  // Oracle: analytic, 2 N at 0.2 N per tick.
  RendererBench bench;
  bench.hold(wall_model(kPressed), resting_at(kPressed), 40);
  for (int i = 1; i <= 10; ++i) {
    const RenderedForce out = bench.tick(resting_at(Vec3(0, std::nan(""), 0)));
    CHECK((out.limits & kForceNotFinite) != 0);
    CHECK(out.force.z() == Approx(2 - 0.2 * i).margin(1e-12));
  }
  CHECK(bench.tick(resting_at(Vec3(0, std::nan(""), 0))).force.norm() < 1e-12);
}

TEST_CASE("haptic renderer: reset forgets the law, and lets go within the slew limit") {
  // Oracle: analytic, 2 N at 0.2 N per tick; then a new renderer, bit for bit. Both have one
  // rounding per tick.
  RendererBench used, fresh;
  used.hold(wall_model(kPressed), resting_at(kPressed), 30);
  used.renderer.update_law(wall_model(kPressed), std::nan(""));
  used.renderer.reset();
  used.ticks = 0;
  CHECK(used.renderer.refused_laws() == 0);
  for (int i = 1; i <= 10; ++i) {
    const RenderedForce out = used.tick(resting_at(kPressed));
    CHECK(out.force.z() == Approx(2 - 0.2 * i).margin(1e-12));
    if (i < 10) CHECK((out.limits & kForceSlewLimited) != 0);
  }
  for (int i = 0; i < 11; ++i) fresh.tick(resting_at(kPressed));
  CHECK(used.tick(resting_at(kPressed)).force.norm() == 0);
  for (int i = 0; i < 20; ++i) {
    const RenderedForce a = used.hold(wall_model(kPressed), resting_at(kPressed), 1);
    const RenderedForce b = fresh.hold(wall_model(kPressed), resting_at(kPressed), 1);
    CHECK(a.force == b.force);
    CHECK(a.limits == b.limits);
  }
}
