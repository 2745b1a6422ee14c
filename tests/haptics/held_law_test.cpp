#include "haptics/held_law.h"

#include <catch2/catch.hpp>

#include "tests/haptics/renderer_bench.h"

using namespace palpate;
using namespace palpate::haptics;
using namespace palpate::testing;

namespace {

/// A renderer of two sources' laws, ticked by hand.
struct TwoSources {
  HapticRenderer renderer{scene::Haptics{}, kT, 2};
  int ticks = 0;

  RenderedForce tick(const LocalLaw* first, const LocalLaw* second) {
    if (ticks % 4 == 0 && first) renderer.update_law(*first, kT * ticks, 0);
    if (ticks % 4 == 2 && second) renderer.update_law(*second, kT * ticks, 1);
    RenderedForce out;
    renderer.tick(kT * ticks++, resting_at(kPressed), out);
    return out;
  }
  RenderedForce run(int count, const LocalLaw* first, const LocalLaw* second) {
    RenderedForce out;
    for (int i = 0; i < count; ++i) out = tick(first, second);
    return out;
  }
};

const LocalLaw kHard = wall_model(kPressed, 100), kSoft = wall_model(kPressed, 50);

}  // namespace

TEST_CASE("held laws: the forces of two sources that speak at different times add") {
  // Oracle: the laws, 1 N and 0.5 N, and their torques, once hand-over and slew are over.
  TwoSources both;
  const RenderedForce out = both.run(60, &kHard, &kSoft);
  CHECK(out.force.z() == Approx(1.5).epsilon(1e-12));
  CHECK((out.torque - kHard.torque() - kSoft.torque()).norm() < 1e-12);
  CHECK(out.limits == kForceNotLimited);
  CHECK(out.contact_model_age == Approx(3 * kT));  // of the one that is behind
}

TEST_CASE("held laws: a source without rows changes no bit") {
  // Oracle: a renderer of one source.
  RendererBench one;
  TwoSources both;
  const LocalLaw open = [] {
    LocalLaw law = wall_model(kPressed, 100);
    law.rows.clear();
    law.compliance.clear();
    law.stiffness.setZero();
    return law;
  }();
  for (int i = 0; i < 60; ++i) {
    if (i % 4 == 0) one.renderer.update_law(kHard, one.time());
    const RenderedForce a = one.tick(resting_at(kPressed)), b = both.tick(&kHard, &open);
    CHECK(a.force == b.force);
    CHECK(a.torque == b.torque);
    CHECK(a.passivity_energy == b.passivity_energy);
    CHECK(a.limits == b.limits);
  }
}

TEST_CASE("held laws: of a source that falls silent the force fades, of the other it stays") {
  // Oracle: the scene's promise, stale_after + fade_time from the last law of the silent one.
  TwoSources both;
  both.run(60, &kHard, &kSoft);
  const scene::Haptics limits;
  const int gone = static_cast<int>((limits.stale_after + limits.fade_time) / kT) + 4;
  for (int i = 0; i < gone; ++i) {
    const RenderedForce out = both.tick(nullptr, &kSoft);
    CHECK(out.force.z() > 0.5 - 1e-9);
    CHECK(out.force.z() < 1.5 + 1e-9);
  }
  const RenderedForce out = both.run(40, nullptr, &kSoft);
  CHECK(out.force.z() == Approx(0.5).epsilon(1e-9));
  CHECK((out.limits & kForceStaleFade) != 0);
  const RenderedForce again = both.run(60, &kHard, &kSoft);
  CHECK(again.force.z() == Approx(1.5).epsilon(1e-9));
  CHECK(again.limits == kForceNotLimited);
}

TEST_CASE(
    "held laws: two that together are too stiff for the device are softened to what it holds") {
  // Oracle: b/(T/2 + t_d) is 100 N/m here, the laws' 150 and 50: the force at the anchor is their
  // own, and a millimetre deeper it has grown by what 100 N/m give.
  scene::Haptics limits;
  limits.device_damping = 100 * kT / 2;
  HapticRenderer renderer(limits, kT, 2);
  const LocalLaw laws[] = {wall_model(kPressed, 150), wall_model(kPressed, 50)};
  RenderedForce out;
  const auto hold = [&](double deeper, int from, int to) {
    DeviceSample device = resting_at(kPressed - Vec3(0, 0, deeper));
    device.delay = 0;
    for (int i = from; i < to; ++i) {
      for (std::size_t source = 0; source < 2 && deeper == 0; ++source) {
        renderer.update_law(laws[source], kT * i, source);
      }
      renderer.tick(kT * i, device, out);
    }
  };
  hold(0, 0, 60);  // hand-over leaves three quarters of a difference to the next tick
  CHECK(out.force.z() == Approx(2).epsilon(1e-6));
  CHECK((out.limits & kStiffnessCapped) != 0);
  hold(1e-3, 60, 90);
  CHECK(out.force.z() == Approx(2 + 100 * 1e-3).epsilon(1e-6));
}
