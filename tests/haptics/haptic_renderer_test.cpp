#include "haptics/haptic_renderer.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>
#include <limits>

#include "tests/haptics/renderer_bench.h"

using namespace palpate;
using namespace palpate::haptics;
using namespace palpate::testing;

TEST_CASE("haptic renderer: without a model there is no force and the age is infinite") {
  // Oracle: the stated behaviour.
  RendererBench bench;
  const RenderedForce out = bench.tick(resting_at(kPressed));
  CHECK(out.force.norm() == 0);
  CHECK(std::isinf(out.contact_model_age));
  CHECK(out.limits == kForceNotLimited);
}

TEST_CASE("haptic renderer: at rest at the anchor it gives exactly the model's force and torque") {
  // Oracle: the model, bit for bit, once hand-over and slew are over.
  RendererBench bench;
  const LocalLaw model = wall_model(kPressed);
  const RenderedForce out = bench.hold(model, resting_at(kPressed), 40);
  CHECK(out.force == model.force());
  CHECK((out.torque - model.torque()).norm() < 1e-15);
  CHECK(out.limits == kForceNotLimited);
  CHECK(out.contact_model_age == Approx(3 * kT));
}

TEST_CASE("haptic renderer: between models the force follows the probe at tick rate") {
  // Oracle: analytic, f = K · depth at every tick though the model is 20 ms old.
  RendererBench bench;
  bench.hold(wall_model(kPressed), resting_at(kPressed), 37);
  for (int i = 1; i <= 20; ++i) {
    DeviceSample sample = resting_at(kPressed - Vec3(0, 0, 5e-5 * i));
    sample.twist.linear.z() = -0.05;
    CHECK(bench.tick(sample).force.z() == Approx(200 * (0.01 + 5e-5 * i)).epsilon(1e-12));
  }
}

TEST_CASE("haptic renderer: a model from the future is as stale as one from the past") {
  // Oracle: the stated rule; a session clock that is set back must not keep an old model alive.
  RendererBench bench;
  bench.renderer.update_law(wall_model(kPressed), 100);
  RenderedForce out;
  for (int i = 0; i < 20; ++i) out = bench.tick(resting_at(kPressed));
  CHECK(out.force.norm() == 0);
  CHECK(out.contact_model_age == Approx(100).epsilon(1e-3));
}

TEST_CASE("haptic renderer: a new model is taken over without a step") {
  // Oracle: analytic. Models 0.1 N apart, four ticks of hand-over: steps of 0.025 N; and the new
  // model holds exactly from the fourth tick on.
  RendererBench bench;
  bench.hold(wall_model(kPressed), resting_at(kPressed), 40);
  LocalLaw next = wall_model(kPressed);
  next.rows[0].force.z() += 0.1;
  bench.renderer.update_law(next, bench.time());
  for (int i = 1; i <= 4; ++i) {
    CHECK(bench.tick(resting_at(kPressed)).force.z() == Approx(2 + 0.025 * i));
  }
  CHECK((bench.tick(resting_at(kPressed)).force - next.force()).norm() < 1e-12);
}

TEST_CASE("haptic renderer: a hand-over never pulls") {
  // Oracle: analytic. 2 N appear at the probe, which leaves by 7.5 mm in the next tick: the model
  // gives 0.5 N there, half of the −2 N of the hand-over is still due. Zero, not −0.5 N.
  scene::Haptics limits;
  limits.max_force_rate = 1e5;
  RendererBench bench(limits);
  bench.hold(LocalLaw{}, resting_at(kPressed), 8);
  bench.renderer.update_law(wall_model(kPressed), bench.time());
  CHECK(bench.tick(resting_at(kPressed)).force.z() == Approx(0.5));
  CHECK(bench.tick(resting_at(kPressed + Vec3(0, 0, 0.0075))).force.z() == 0);
}

TEST_CASE("haptic renderer: a hand-over takes the model's period, at most 25 ms") {
  // Oracle: analytic. 0.1 N over 10 ticks of a model at 100 Hz, however late the model before was;
  // over 25 of one at 10 Hz.
  for (const auto& [period, ticks] : {std::pair{0.01, 10}, std::pair{0.1, 25}}) {
    RendererBench bench;
    bench.hold(wall_model(kPressed), resting_at(kPressed), 40);
    LocalLaw next = wall_model(kPressed);
    next.period = period;
    next.rows[0].force.z() += 0.1;
    bench.renderer.update_law(next, bench.time());
    for (int i = 1; i <= ticks; ++i) {
      CHECK(bench.tick(resting_at(kPressed)).force.z() == Approx(2 + 0.1 * i / ticks));
    }
  }
}

TEST_CASE("haptic renderer: models as fast as the loop are not delayed") {
  // Oracle: the stated rule, spread over the model's period.
  RendererBench bench;
  bench.hold(wall_model(kPressed), resting_at(kPressed), 40);
  LocalLaw model = wall_model(kPressed);
  model.period = kT;
  bench.renderer.update_law(model, bench.time());
  bench.tick(resting_at(kPressed));
  for (int i = 1; i <= 10; ++i) {
    model.rows[0].force.z() = 2 + 0.02 * i;
    bench.renderer.update_law(model, bench.time());
    CHECK(bench.tick(resting_at(kPressed)).force.z() == Approx(model.force().z()).epsilon(1e-12));
  }
}

TEST_CASE("haptic renderer: a refused model is counted and said once, the one before holds") {
  // Oracle: the stated behaviour.
  RendererBench bench;
  bench.hold(wall_model(kPressed), resting_at(kPressed), 40);
  LocalLaw bad = wall_model(kPressed);
  bad.rows[0].force.x() = std::numeric_limits<double>::quiet_NaN();
  bench.renderer.update_law(bad, bench.time());
  bench.renderer.update_law(wall_model(kPressed), std::nan(""));
  CHECK(bench.renderer.refused_laws() == 2);
  RenderedForce out = bench.tick(resting_at(kPressed));
  CHECK((out.limits & kForceNotFinite) != 0);
  CHECK(out.force.z() == 2);
  out = bench.tick(resting_at(kPressed));
  CHECK(out.limits == kForceNotLimited);
  CHECK(out.contact_model_age > 4 * kT);
}

TEST_CASE("haptic renderer: what the device reports of itself reaches the force message") {
  // Oracle: the bits put in.
  RendererBench bench;
  DeviceSample sample = resting_at(kPressed);
  sample.limits = kPoseSlewed | kPoseRefused;
  CHECK(bench.tick(sample).limits == (kPoseSlewed | kPoseRefused));
}

TEST_CASE("haptic renderer: a shell that gives way is felt on its way out as its law is") {
  // Oracle: the law's own force, from which a slow release with laws of 250 Hz is off by what the
  // force changes in a period and a half; it is given back all it took, so nothing may be taken
  // away. At 20 mm the force has fallen to a third of its most.
  const auto shell = [](double depth) {
    return 0.4 * std::sin(std::min(std::max(depth, 0.0) * 140, 2.8));
  };
  RendererBench bench(scene::Haptics{});
  double off = 0, most = 0;
  for (int i = 0; i <= 4000; ++i) {
    const double depth = 0.02 * (i < 2000 ? i / 2000.0 : 2 - i / 2000.0);
    LocalLaw law = wall_law(Vec3(0, 0, -depth), 0, 100);
    law.rows[0].force.z() = shell(depth);
    law.period = 4 * kT;
    if (i % 4 == 0) bench.renderer.update_law(law, bench.time());
    DeviceSample device = resting_at(Vec3(0, 0, -depth));
    device.twist.linear.z() = i < 2000 ? -0.01 : 0.01;
    const RenderedForce out = bench.tick(device);
    INFO("at " << depth << " m");
    REQUIRE((out.limits & kForcePassivity) == 0);
    off = std::max(off, std::abs(out.force.z() - shell(depth)));
    most = std::max(most, out.force.z());
  }
  CHECK(most == Approx(0.4).epsilon(0.02));
  CHECK(off < 0.01 * 1.5 * 4 * kT * (0.4 * 140 + 100));
}
