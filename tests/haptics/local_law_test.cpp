#include "haptics/local_law.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "modules/core/tolerances.h"

using namespace palpate;
using namespace palpate::haptics;

namespace {

/// Wall z ≤ 0 of 200 N/m, pressed 5 mm deep; tangentially 100 N/m; 0.3 N of friction at the anchor.
LocalLaw pressed_wall() {
  LocalLaw model;
  model.touching = true;
  model.anchor = Vec3(0.1, 0.2, -0.005);
  model.force = Vec3(0.3, 0, 1);
  model.torque = Vec3(0, 0.02, 0);
  model.stiffness = Vec3(100, 100, 200).asDiagonal();
  model.friction_coefficient = 0.5;
  model.validity_radius = 0.01;
  return model;
}

}  // namespace

TEST_CASE("local contact model: at its anchor it gives exactly the model's force and torque") {
  // Oracle: the model itself, bit for bit, where it is inside the cone.
  const LocalLaw model = pressed_wall();
  const LawForce at_anchor = evaluate(model, model.anchor);
  CHECK(at_anchor.wrench.force == model.force);
  CHECK(at_anchor.wrench.torque == model.torque);
  CHECK_FALSE(at_anchor.beyond_validity);
}

TEST_CASE("local contact model: linear near the anchor, and never pulling") {
  // Oracle: analytic, f = force + K (anchor − x); the wall's surface is 5 mm above the anchor.
  const LocalLaw model = pressed_wall();
  const auto force_at = [&](double dx, double dz) {
    return evaluate(model, model.anchor + Vec3(dx, 0, dz)).wrench.force;
  };
  CHECK((force_at(0, -0.004) - Vec3(0.3, 0, 1.8)).norm() < 1e-13);
  CHECK((force_at(0.001, 0.001) - Vec3(0.2, 0, 0.8)).norm() < 1e-13);
  CHECK(force_at(0, 0.005).norm() < 1e-13);
  CHECK(force_at(0, 0.007).norm() == 0);
  CHECK(evaluate(model, model.anchor + Vec3(0, 0, 0.0049)).wrench.force.z() > 0);
}

TEST_CASE("local contact model: the tangential force stays on the friction cone") {
  // Oracle: analytic, |f_t| = min(spring, μ f_n), in the spring's direction.
  LocalLaw model = pressed_wall();
  const Vec3 slid = evaluate(model, model.anchor + Vec3(0.009, 0, 0)).wrench.force;
  CHECK((slid - Vec3(-0.5, 0, 1)).norm() < 1e-13);
  model.friction_coefficient = 0;
  const Vec3 smooth = evaluate(model, model.anchor).wrench.force;
  CHECK((smooth - Vec3(0, 0, 1)).norm() < 1e-13);
}

TEST_CASE("local contact model: beyond the validity radius it is evaluated at the radius") {
  // Oracle: analytic. 30 mm deeper counts as 10 mm.
  const LocalLaw model = pressed_wall();
  const LawForce far = evaluate(model, model.anchor - Vec3(0, 0, 0.03));
  CHECK(far.beyond_validity);
  CHECK((far.wrench.force - Vec3(0.3, 0, 3)).norm() < 1e-13);
  CHECK_FALSE(evaluate(model, model.anchor - Vec3(0, 0, 0.0099)).beyond_validity);
}

TEST_CASE("local contact model: the torque keeps its lever arm") {
  // Oracle: analytic, torque proportional to the normal force.
  const LocalLaw model = pressed_wall();
  const LawForce deeper = evaluate(model, model.anchor - Vec3(0, 0, 0.005));
  CHECK((deeper.wrench.torque - Vec3(0, 0.04, 0)).norm() < 1e-15);
  CHECK(evaluate(model, model.anchor + Vec3(0, 0, 0.006)).wrench.torque.norm() == 0);
}

TEST_CASE("local contact model: not touching gives nothing, whatever else it says") {
  // Oracle: the rule.
  LocalLaw model = pressed_wall();
  model.touching = false;
  CHECK(evaluate(model, model.anchor).wrench.force.norm() == 0);
  CHECK(evaluate(model, model.anchor).wrench.torque.norm() == 0);
  CHECK_FALSE(evaluate(model, model.anchor + Vec3(1, 0, 0)).beyond_validity);
}

TEST_CASE("local contact model: random models never pull and never leave the cone") {
  // Oracle: invariants. Tolerance: 1e-12 of the force, rounding.
  std::mt19937 random(5);
  std::normal_distribution<double> any;
  const auto vector = [&] { return Vec3(any(random), any(random), any(random)); };
  for (int i = 0; i < 5000; ++i) {
    LocalLaw model;
    model.touching = true;
    model.force = vector();
    const Vec3 a = 10 * vector(), b = 10 * vector();
    model.stiffness = a * a.transpose() + b * b.transpose();
    model.normal = vector().normalized();
    model.friction_coefficient = std::abs(any(random));
    model.validity_radius = 0.01 * std::abs(any(random));
    const Vec3 force = evaluate(model, 0.01 * vector()).wrench.force;
    const double normal = model.normal.dot(force);
    const double tangential = (force - normal * model.normal).norm();
    REQUIRE(normal >= -1e-12 * force.norm());
    REQUIRE(tangential <= model.friction_coefficient * normal + 1e-12 * force.norm());
  }
}

TEST_CASE("local contact model: only complete, finite models are usable") {
  // Oracle: the stated rules, one violated at a time.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(is_usable(pressed_wall()));
  const auto refused = [](auto spoil) {
    LocalLaw model = pressed_wall();
    spoil(model);
    return !is_usable(model);
  };
  CHECK(refused([&](LocalLaw& m) { m.anchor.x() = nan; }));
  CHECK(refused([&](LocalLaw& m) { m.force.y() = HUGE_VAL; }));
  CHECK(refused([&](LocalLaw& m) { m.torque.z() = nan; }));
  CHECK(refused([&](LocalLaw& m) { m.stiffness(1, 2) = nan; }));
  CHECK(refused([&](LocalLaw& m) { m.normal.x() = nan; }));
  CHECK(refused([&](LocalLaw& m) { m.normal *= 1 + 2 * kUnitTolerance; }));
  CHECK(refused([&](LocalLaw& m) { m.normal.setZero(); }));
  CHECK(refused([&](LocalLaw& m) { m.friction_coefficient = -0.1; }));
  CHECK(refused([&](LocalLaw& m) { m.friction_coefficient = nan; }));
  CHECK(refused([&](LocalLaw& m) { m.validity_radius = -1; }));
  CHECK(refused([&](LocalLaw& m) { m.validity_radius = HUGE_VAL; }));
}
