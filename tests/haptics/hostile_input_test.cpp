// The promise of the whole chain: whatever models, poses and times come in, what goes out is
// finite, at most max_force, and changes by at most max_force_rate · T per tick.
#include <catch2/catch.hpp>

#include "haptics/haptic_renderer.h"
#include "tests/haptics/hostile_numbers.h"

using namespace palpate;
using namespace palpate::haptics;

namespace {

/// Usable now and then, else with anything anywhere.
LocalLaw any_model(HostileNumbers& numbers) {
  LocalLaw model;
  model.touching = numbers.below(8) != 0;
  model.anchor = 0.01 * numbers.vector();
  model.force = numbers.vector();
  model.torque = numbers.vector();
  const Vec3 a = 10 * numbers.vector();
  model.stiffness = a * a.transpose();
  if (numbers.below(10) == 0) model.stiffness.row(1) = numbers.vector();
  const Vec3 direction = numbers.vector();
  model.normal = numbers.below(10) == 0 ? direction : direction.stableNormalized();
  model.friction_coefficient = numbers.below(10) == 0 ? numbers.number() : 0.3;
  model.validity_radius = numbers.below(10) == 0 ? numbers.number() : 0.005;
  return model;
}

}  // namespace

TEST_CASE("hostile input: force, torque and their steps stay within the limits, always") {
  // Oracle: invariants; tolerance 1e-12 of the largest force (rounding).
  scene::Haptics limits;
  limits.max_force_rate = GENERATE(1.0, 200.0, 1e5);
  const double period = 1e-3;
  HapticRenderer renderer(limits, period);
  HostileNumbers numbers(3);
  RenderedForce before, after;
  double time = 0;
  int pushed = 0;
  for (int i = 0; i < 20'000; ++i) {
    time = numbers.below(1000) == 0 ? 0 : time + period;
    if (numbers.below(4) == 0) {
      renderer.update_law(any_model(numbers), numbers.below(50) == 0 ? numbers.number() : time);
    }
    DeviceSample device;
    device.pose.position = 0.01 * numbers.vector();
    device.twist.linear = 0.1 * numbers.vector();
    renderer.tick(numbers.below(100) == 0 ? numbers.number() : time, device, after);
    REQUIRE(after.force.allFinite());
    REQUIRE(after.torque.allFinite());
    REQUIRE(std::isfinite(after.passivity_energy));
    REQUIRE(after.contact_model_age >= 0);
    const double step = limits.max_force_rate * period, slack = 1e-12 * limits.max_force;
    REQUIRE(after.force.norm() <= limits.max_force + slack);
    REQUIRE((after.force - before.force).norm() <= step + slack);
    REQUIRE(after.torque.norm() <= limits.max_force * HapticRenderer::kTorqueArm + slack);
    REQUIRE((after.torque - before.torque).norm() <= step * HapticRenderer::kTorqueArm + slack);
    pushed += after.force.norm() > 0;
    before = after;
  }
  CHECK(pushed > 5000);  // the test does test forces
  CHECK(renderer.refused_laws() > 500);
}
