#include "haptics/devices/scripted_device.h"

#include <catch2/catch.hpp>

using namespace palpate;
using haptics::ScriptedDevice;

namespace {

scene::ScriptedDevice press() {
  scene::ScriptedDevice script;
  script.start = Vec3(0, 0, 0.1);
  script.rotation = Quat(0.8, 0, 0.6, 0);
  script.moves = {{Vec3(0, 0, 0.08), 0.5}, {std::nullopt, 1.0}, {Vec3(0.02, 0, 0.08), 2.0}};
  return script;
}

}  // namespace

TEST_CASE("scripted device: moves follow the minimum-jerk profile") {
  // Oracle: analytic, s(τ) = 10τ³ − 15τ⁴ + 6τ⁵; s(¼) = 0.103515625, s(½) = ½, peak speed 15/8.
  ScriptedDevice device(press());
  CHECK(device.read(0.125).pose.position.z() == Approx(0.1 - 0.02 * 0.103515625).epsilon(1e-14));
  CHECK(device.read(0.25).pose.position.z() == Approx(0.09).epsilon(1e-14));
  CHECK(device.read(0.25).twist.linear.z() == Approx(-15.0 / 8 * 0.02 / 0.5).epsilon(1e-14));
  CHECK(device.read(2.5).pose.position.x() == Approx(0.01).epsilon(1e-14));
}

TEST_CASE("scripted device: waits, and holds its ends at rest") {
  // Oracle: the script.
  ScriptedDevice device(press());
  for (const double t : {-1.0, 0.0}) {
    CHECK(device.read(t).pose.position == Vec3(0, 0, 0.1));
    CHECK(device.read(t).twist.linear.norm() == 0);
  }
  for (const double t : {0.5, 1.0, 1.5}) {
    CHECK((device.read(t).pose.position - Vec3(0, 0, 0.08)).norm() < 1e-16);
    CHECK(device.read(t).twist.linear.norm() < 1e-15);
  }
  for (const double t : {3.5, 1e6}) {
    CHECK((device.read(t).pose.position - Vec3(0.02, 0, 0.08)).norm() < 1e-16);
    CHECK(device.read(t).twist.linear.norm() == 0);
  }
  CHECK(device.read(2).pose.rotation.coeffs().isApprox(Quat(0.8, 0, 0.6, 0).coeffs()));
  CHECK(device.read(2).twist.angular.norm() == 0);
}

TEST_CASE("scripted device: the twist is the derivative of the position") {
  // Oracle: central finite difference; error e²/6·60·20 mm/0.5³ s³ = 1.6e-12 m/s, plus rounding
  // of positions 1e-17/e = 1e-11.
  ScriptedDevice device(press());
  const double e = 1e-6;
  for (double t = 0.003; t < 4; t += 0.0101) {
    const Vec3 secant =
        (device.read(t + e).pose.position - device.read(t - e).pose.position) / (2 * e);
    REQUIRE((secant - device.read(t).twist.linear).norm() < 1e-10);
  }
}

TEST_CASE("scripted device: without moves it stays at its start") {
  // Oracle: the script.
  scene::ScriptedDevice script;
  script.start = Vec3(1, 2, 3);
  CHECK(ScriptedDevice(script).read(5).pose.position == script.start);
}
