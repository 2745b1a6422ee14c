#include "haptics/pressed_work.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

namespace palpate::haptics {
namespace {

constexpr double kStep = 2e-5;  ///< of a tick [m]

using Curve = std::function<double(double)>;

/// Presses along −z, against a force of the curve, and back.
class Pressed {
 public:
  explicit Pressed(Curve curve) : curve_(std::move(curve)) { work_.clear(Vec3::Zero()); }

  void go_to(double depth) {
    while (std::abs(depth - depth_) > kStep / 2) {
      depth_ += std::copysign(kStep, depth - depth_);
      const Vec3 force(0, 0, curve_(depth_));
      work_.move(Vec3(0, 0, -depth_), force, force);
    }
  }
  double returnable() const { return work_.returnable(); }

 private:
  Curve curve_;
  PressedWork work_;
  double depth_ = 0;
};

double energy(const Curve& curve, double depth) {
  double sum = 0;
  for (double x = kStep / 2; x < depth; x += kStep) sum += kStep * curve(x);
  return sum;
}

TEST_CASE("pressed work: a contact that gives way can give back what it took, at every depth") {
  // Oracle: quadrature of the curve. The force falls off, and falls, with depth; knots are 0.8 mm
  // apart for 40 mm, between which the curve is taken as straight.
  const Curve softens = [](double d) { return 0.4 * std::tanh(d / 4e-3); };
  const Curve buckles = [](double d) { return 0.4 * std::sin(std::min(d, 0.04) * 70) + 0.02 * d; };
  for (const Curve& curve : {softens, buckles}) {
    Pressed pressed(curve);
    for (const double depth : {0.01, 0.04, 0.03, 0.012, 0.02, 0.004, 1e-3}) {
      pressed.go_to(depth);
      INFO("at " << depth);
      CHECK(pressed.returnable() == Approx(energy(curve, depth)).epsilon(0.01).margin(2e-5));
    }
  }
}

TEST_CASE("pressed work: of a contact that stiffens it is no more than half its force by the way") {
  // Oracle: analytic: of d² a third, of a spring the half.
  const Curve stiffens = [](double d) { return 1e3 * d * d; };
  Pressed pressed(stiffens);
  pressed.go_to(0.02);
  CHECK(pressed.returnable() == Approx(0.5 * stiffens(0.02) * 0.02).epsilon(0.01));
}

TEST_CASE(
    "pressed work: what friction takes is not given back, and no depth is left beyond touch") {
  // Oracle: definition. The probe slides by 0.3 m across what presses; then it is let go and
  // touched again.
  PressedWork work;
  work.clear(Vec3::Zero());
  const Vec3 pressing(0, 0, 1), force(-0.3, 0, 1);
  for (int i = 1; i <= 100; ++i) work.move(Vec3(0, 0, -1e-4 * i), pressing, pressing);
  const double before = work.returnable();
  CHECK(before == Approx(0.01));
  for (int i = 1; i <= 100; ++i) work.move(Vec3(1e-4 * i, 0, -0.01), force, pressing);
  CHECK(work.returnable() == Approx(before).epsilon(0.01));
  for (int i = 1; i <= 200; ++i) work.move(Vec3(0.01, 0, -0.01 + 1e-4 * i), pressing, pressing);
  CHECK(work.returnable() < 1e-12);
  work.clear(Vec3::Zero());
  CHECK(work.returnable() == 0);
}

TEST_CASE("pressed work: tissue that comes to a probe at rest pushes it by half its force") {
  // Oracle: definition. The force grows while the probe stands.
  PressedWork work;
  work.clear(Vec3::Zero());
  work.move(Vec3(0, 0, -1e-3), Vec3(0, 0, 0.1), Vec3(0, 0, 0.1));
  for (int i = 1; i <= 100; ++i) {
    const Vec3 force(0, 0, 0.1 + 0.01 * i);
    work.move(Vec3(0, 0, -1e-3), force, force);
  }
  CHECK(work.returnable() == Approx(0.5 * 1.1 * 1e-3));
}

TEST_CASE("pressed work: any way and force leave it a number that is not negative") {
  // Oracle: definition; ways of up to a kilometre a tick, forces of up to a meganewton.
  PressedWork work;
  work.clear(Vec3::Zero());
  for (int i = 0; i < 2000; ++i) {
    const double way = std::pow(10.0, i % 10 - 6) * ((i * 7) % 5 - 2);
    const double strength = std::pow(10.0, i % 13 - 6);
    work.move(Vec3(way, -way, 2 * way), Vec3(strength, 0, -strength), Vec3(0, strength, strength));
    REQUIRE(std::isfinite(work.returnable()));
    REQUIRE(work.returnable() >= 0);
  }
}

}  // namespace
}  // namespace palpate::haptics
