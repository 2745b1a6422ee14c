#include "deformation/contact/contact_response.h"

#include <catch2/catch.hpp>

namespace palpate::deformation {
namespace {

constexpr double kPeriod = 4e-3;

/// Presses a linear spring wall k at z = 0 along a path of depths; the normal is +z.
LocalLaw press(double k, const std::vector<double>& depths, double limit = 1e9) {
  ContactResponse response;
  for (const double depth : depths) {
    response.begin(kPeriod);
    if (depth > 0) {
      response.add(Vec3(0, 0, k * depth * kPeriod), Vec3::UnitZ(), Vec3(0.01, 0, 0), Vec3::Zero());
    }
    response.end(Vec3(0, 0, -depth), limit);
  }
  LocalLaw model;
  response.write(model);
  return model;
}

std::vector<double> ramp(double speed, int cycles) {
  std::vector<double> depths;
  for (int i = 0; i <= cycles; ++i) depths.push_back(speed * kPeriod * i);
  return depths;
}

TEST_CASE("contact response: finds the stiffness of a linear wall from 1 to 100 mm/s") {
  // Oracle: analytic. The prior of (10 µm)² stands against Σ Δx² = step · 1 mm (geometric sum), at
  // 1 mm/s and 4 ms per step that is 1e-10 against 4e-9 m²; after 0.4 s a third of the sum is
  // there.
  const double speed = GENERATE(0.001, 0.01, 0.1);
  const auto model = press(200, ramp(speed, 100));
  CHECK(model.stiffness(2, 2) == Approx(200).epsilon(speed < 0.002 ? 0.1 : 0.01));
  CHECK(model.stiffness(2, 2) <= 200 * (1 + 1e-9));
  CHECK(model.stiffness(0, 0) == Approx(2.0 / 3 * model.stiffness(2, 2)));
}

TEST_CASE("contact response: force, torque and anchor are those of the last advance") {
  // Oracle: analytic, r × f with r = (0.01, 0, 0).
  const auto model = press(200, {0.001, 0.002});
  CHECK(model.touching);
  CHECK(model.force.z() == Approx(0.4));
  CHECK(model.torque.y() == Approx(-0.004));
  CHECK(model.anchor.z() == -0.002);
  CHECK(model.normal == Vec3::UnitZ());
}

TEST_CASE("contact response: knows nothing at first touch and forgets when it ends") {
  // Oracle: definition.
  CHECK(press(200, {0, 0.001}).stiffness.isZero());
  auto depths = ramp(0.01, 100);
  depths.push_back(0);
  const auto model = press(200, depths);
  CHECK_FALSE(model.touching);
  CHECK(model.stiffness.isZero());
  CHECK(model.force.isZero());
}

TEST_CASE("contact response: never believes more than the limit, nor a negative stiffness") {
  // Oracle: definition.
  CHECK(press(200, ramp(0.01, 100), 50).stiffness(2, 2) == 50);
  auto depths = ramp(0.01, 100);
  const auto model = press(-200, depths);  // pulls: no touching wall does
  CHECK(model.stiffness(2, 2) >= 0);
}

TEST_CASE("contact response: holding still keeps the estimate") {
  // Oracle: no motion, no information.
  auto depths = ramp(0.02, 100);
  const double last = depths.back();
  const double before = press(200, depths).stiffness(2, 2);
  for (int i = 0; i < 1000; ++i) depths.push_back(last);
  CHECK(press(200, depths).stiffness(2, 2) == Approx(before).epsilon(1e-12));
}

}  // namespace
}  // namespace palpate::deformation
