#include "haptics/passivity.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/times.h"

using namespace palpate;
using haptics::PassivityControl;
using haptics::Wrench;

namespace {

constexpr double kPlenty = 1;  ///< returnable energy that bounds nothing [J]

Pose at(double z) { return {Vec3(0, 0, z), Quat::Identity()}; }
Wrench force(double x, double y, double z) { return {Vec3(x, y, z), Vec3::Zero()}; }
Twist moving(double x, double y, double z) { return {Vec3(x, y, z), Vec3::Zero()}; }

}  // namespace

TEST_CASE("passivity: the observed energy is the sum of force held times motion made") {
  // Oracle: analytic. Pressing 10 steps of 1 mm against 2 N puts in 20 mJ; b = 0.5 adds b dx²/T.
  PassivityControl passivity(0.5, kTick);
  passivity.observe(at(0), kPlenty);
  for (int i = 1; i <= 10; ++i) {
    passivity.held(force(0, 0, 2));
    passivity.observe(at(-0.001 * i), kPlenty);
  }
  CHECK(passivity.energy() == Approx(0.020 + 10 * 0.5 * 1e-6 / kTick));
}

TEST_CASE("passivity: a force that takes in energy, or returns what was put in, is left alone") {
  // Oracle: identity, bit for bit.
  PassivityControl passivity(0, kTick);
  const Wrench pushed = force(0, 0, 2);
  passivity.observe(at(0), kPlenty);
  CHECK(passivity.controlled(pushed, moving(0, 0, -0.1)) == pushed);
  passivity.held(pushed);
  passivity.observe(at(-0.001), kPlenty);                             // 2 mJ in
  CHECK(passivity.controlled(pushed, moving(0, 0, 0.5)) == pushed);   // 1 mJ out
  CHECK(passivity.controlled(pushed, moving(0, 0, 0.99)) == pushed);  // 1.98 mJ out
}

TEST_CASE("passivity: a push that would generate energy is cut to what brings E to zero") {
  // Oracle: analytic, E + T(−f v) = 0 gives f = E/(T v) = 2 mJ/(1 ms · 2 m/s) = 1 N.
  PassivityControl passivity(0, kTick);
  passivity.observe(at(0), kPlenty);
  passivity.held(force(0, 0, 2));
  passivity.observe(at(-0.001), kPlenty);
  const Wrench cut = passivity.controlled(force(0.5, 0, 2), moving(0, 0, 2));
  CHECK((cut.force - Vec3(0.5, 0, 1)).norm() < 1e-12);  // across the motion nothing changes
}

TEST_CASE("passivity: the device's damping pays for that much generated energy") {
  // Oracle: analytic. b v = 0.2 · 0.5 = 0.1 N may be pushed for nothing.
  PassivityControl passivity(0.2, kTick);
  passivity.observe(at(0), kPlenty);
  const Twist twist = moving(0.5, 0, 0);
  CHECK(passivity.controlled(force(0.0999, 0, 0), twist) == force(0.0999, 0, 0));
  const Wrench cut = passivity.controlled(force(0.3, 0, 0), twist);
  CHECK((cut.force - Vec3(0.1, 0, 0)).norm() < 1e-12);
}

TEST_CASE("passivity: debt is paid back by damping of at most the stated size") {
  // Oracle: analytic. 8 mJ generated; at 0.1 m/s a full repayment in a tick would take 80 N.
  PassivityControl passivity(0, kTick);
  passivity.observe(at(0), kPlenty);
  passivity.held(force(0, 0, 2));
  passivity.observe(at(0.004), kPlenty);
  REQUIRE(passivity.energy() == Approx(-0.008));
  const Twist twist = moving(0, 0, 0.1);
  const double damping = PassivityControl::kMaxAddedDamping * 0.1;
  CHECK(passivity.controlled({}, twist).force.z() == Approx(-damping));
  CHECK(passivity.controlled(force(0, 0, 2), twist).force.z() == Approx(-damping));
  // Against the motion the force already takes energy in; damping comes on top.
  CHECK(passivity.controlled(force(0, 0, -1), twist).force.z() == Approx(-1 - damping));
  CHECK(passivity.controlled(force(0, 0, 2), {}) == force(0, 0, 2));
}

TEST_CASE("passivity: below 20 mm/s it takes of a push what goes with the speed") {
  // Oracle: the stated rule. 8 mJ generated, a push of 2 N.
  PassivityControl passivity(0, kTick);
  passivity.observe(at(0), kPlenty);
  passivity.held(force(0, 0, 2));
  passivity.observe(at(0.004), kPlenty);
  for (const double speed : {0.0001, 0.005, 0.01, 0.02, 0.05}) {
    const double part = std::min(1.0, speed / PassivityControl::kFirmFrom);
    CHECK(passivity.controlled(force(0, 0, 2), moving(0, 0, speed)).force.z() ==
          Approx(2 - 2 * part - PassivityControl::kMaxAddedDamping * speed));
  }
}

TEST_CASE("passivity: energy is bounded by what the contact can return, and by the largest debt") {
  // Oracle: the stated bounds.
  PassivityControl passivity(0, kTick);
  passivity.observe(at(0), kPlenty);
  passivity.held(force(0, 0, 2));
  passivity.observe(at(-1), 0.003);
  CHECK(passivity.energy() == 0.003);
  passivity.observe(at(1), 0.003);
  CHECK(passivity.energy() == -PassivityControl::kMaxDebt);
  passivity.clear();
  CHECK(passivity.energy() == 0);
  passivity.observe(at(5), 0.003);  // the way since the last position is not known
  CHECK(passivity.energy() == 0);
}

namespace {

/// In debt, and for a quarter of a second where `z_at(tick)` says [m]; E after that [J].
template <typename Path>
double energy_after(Path z_at, double returnable) {
  PassivityControl passivity(0, kTick);
  passivity.observe(at(-0.001), returnable);
  passivity.held(force(0, 0, 2));
  passivity.observe(at(0), returnable);
  REQUIRE(passivity.energy() == Approx(-0.002));
  passivity.held({});
  for (int i = 0; i < 250; ++i) passivity.observe(at(z_at(i)), returnable);
  return passivity.energy();
}

}  // namespace

TEST_CASE("passivity: a device at rest owes nothing, an encoder's steps to and fro included") {
  // Oracle: the stated rule. One step in seven readings is rest; as fast as 5 mm/s, or a vibration
  // of a tenth of an encoder step at 50 Hz, read exactly, is none.
  constexpr double kStep = 5.5e-5, kReturnable = 0.003;
  CHECK(energy_after([](int) { return 0.; }, kReturnable) == kReturnable);
  CHECK(energy_after([](int i) { return i % 14 < 4 ? kStep : 0; }, kReturnable) == kReturnable);
  CHECK(energy_after([](int i) { return std::floor(i * 5e-6 / kStep) * kStep; }, kReturnable) < 0);
  CHECK(energy_after([](int i) { return 0.1 * kStep * std::sin(0.1 * M_PI * i + 1); },
                     kReturnable) < 0);
}

TEST_CASE("passivity: a device at rest that has put energy in gets no more than that back") {
  // Oracle: the stated rule. 1 mJ put in is more than 2 N over 0.1 mm, and stays; 0.1 mJ is not.
  for (const double way : {5e-4, 5e-5}) {
    PassivityControl passivity(0, kTick);
    passivity.observe(at(way), 0.003);
    passivity.held(force(0, 0, 2));
    for (int i = 0; i < 100; ++i) passivity.observe(at(0), 0.003);
    CHECK(passivity.energy() == Approx(way > 1e-4 ? 2 * way : 0.003));
  }
}

TEST_CASE("passivity: who rested before a contact appears begins with what it can return") {
  // Oracle: the stated rule, either way.
  for (const bool rested : {true, false}) {
    PassivityControl passivity(0, kTick);
    for (int i = -100; i < 0; ++i) passivity.watch(at(rested ? 0 : 1e-5 * i));
    passivity.observe(at(0), 0.003);
    CHECK(passivity.energy() == (rested ? 0.003 : 0));
  }
}

TEST_CASE("passivity: a turn against a torque counts, and a torque that leaks is cut") {
  // Oracle: analytic. 0.02 N·m turned back by 0.1 rad takes in 2 mJ; at 4 rad/s, that is 0.4 m/s at
  // the arm, it may give back 2 mJ/(1 ms · 4 rad/s) = 0.5 N·m in a tick, not 0.6.
  PassivityControl passivity(0, kTick);
  passivity.observe(at(0), kPlenty);
  passivity.held({Vec3::Zero(), Vec3(0, 0.02, 0)});
  passivity.observe({Vec3::Zero(), Quat(Eigen::AngleAxisd(-0.1, Vec3::UnitY()))}, kPlenty);
  CHECK(passivity.energy() == Approx(0.002));
  const Twist turning{Vec3::Zero(), Vec3(0, 4, 0)};
  const Wrench small{Vec3::Zero(), Vec3(0, 0.5, 0)}, large{Vec3::Zero(), Vec3(0, 0.6, 0)};
  CHECK(passivity.controlled(small, turning) == small);
  CHECK(passivity.controlled(large, turning).torque.y() == Approx(0.5));
}

TEST_CASE("passivity: motions too large for a number leave the energy as it was") {
  // Oracle: invariant, E stays finite.
  PassivityControl passivity(0.2, kTick);
  passivity.held(force(1, 1, 1));
  passivity.observe(at(0), kPlenty);
  passivity.observe({Vec3(1e308, 0, 0), Quat::Identity()}, kPlenty);
  passivity.observe({Vec3(-1e308, 0, 0), Quat::Identity()}, kPlenty);
  CHECK(passivity.energy() == 0);
  CHECK(passivity.controlled(force(1, 0, 0), moving(1e308, 1e308, 1e308)).is_finite());
}
