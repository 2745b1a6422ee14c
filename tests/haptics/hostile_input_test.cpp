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
  const auto now_and_then = [&](double usual) {
    return numbers.below(20) == 0 ? numbers.number() : usual;
  };
  model.anchor.position = 0.01 * numbers.vector();
  model.anchor_age = now_and_then(0.001);
  model.period = now_and_then(0.004);
  model.growth = now_and_then(10);
  model.friction_coefficient = now_and_then(numbers.below(2) == 0 ? 0 : 0.3);
  model.validity_radius = now_and_then(0.005);
  model.rows.resize(numbers.below(4));
  for (LawRow& row : model.rows) {
    const Vec3 direction = numbers.vector();
    row.normal = numbers.below(20) == 0 ? direction : direction.stableNormalized();
    row.point_P = 0.01 * numbers.vector();
    row.gap = now_and_then(0);
    row.radius = now_and_then(numbers.below(2) == 0 ? 0 : 0.008);
    row.force = std::abs(numbers.number()) * row.normal;
    row.velocity = 0.1 * numbers.vector();
  }
  const std::size_t size = model.directions() * model.rows.size();
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      model.compliance.push_back(now_and_then(i == j ? 0.005 : 0.001));
    }
  }
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
    if (numbers.below(2) == 0) device.delay = std::abs(numbers.number());
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
