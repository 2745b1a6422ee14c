// A hand at rest around which an elastic wall appears, with a device that reads in encoder steps.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>

#include "haptics/devices/emulated_device.h"
#include "haptics/haptic_renderer.h"
#include "tests/haptics/wall_law.h"
#include "tests/times.h"

using namespace palpate;
using namespace palpate::haptics;

namespace {

struct Wall {
  Vec3 normal;       ///< unit, towards the probe
  double stiffness;  ///< [N/m]
  double depth;      ///< at which it appears around the tip [m]
};

/// wall_law(), turned to the normal.
LocalLaw law_at(const Vec3& position, const Wall& wall) {
  const double height = position.dot(wall.normal) - wall.depth;
  LocalLaw law = testing::wall_law(Vec3(0, 0, height), wall.stiffness);
  law.anchor.position = position;
  law.rows[0].normal = wall.normal;
  law.rows[0].force = law.rows[0].force.z() * wall.normal;
  law.stiffness = law.stiffness(2, 2) * wall.normal * wall.normal.transpose();
  law.period = 4 * kTick;
  return law;
}

struct Felt {
  double step = 0;               ///< largest change of the force from tick to tick [N]
  double force = 0, energy = 0;  ///< at the end [N, J]
};

/// From half a second after the wall appeared, to four.
Felt felt(const scene::EmulatedDevice& config, const Wall& wall) {
  EmulatedDevice device(config);
  HapticRenderer renderer(scene::Haptics{}, kTick);
  RenderedForce out;
  Felt result;
  for (int i = 0; i < 4000; ++i) {
    const double time = kTick * i;
    const DeviceSample sample = device.read(time);
    if (i % 4 == 0) renderer.update_law(law_at(sample.pose.position, wall), time);
    const Vec3 before = out.force;
    renderer.tick(time, sample, out);
    device.feel(out);
    if (i >= 500) result.step = std::max(result.step, (out.force - before).norm());
  }
  result.force = out.force.norm();
  result.energy = out.passivity_energy;
  return result;
}

}  // namespace

TEST_CASE("resting hand: a wall that appears around it is felt without steps, and leaves no debt") {
  // Oracle: invariants. A step of 0.05 N, or of 5 % of the force, is not felt; a hand at rest owes
  // nothing. The force is that of two springs in series; a tenth for encoder steps.
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0.1, -1, 0.05), Vec3(1, 1, 0)}) {
    for (const double stiffness : {15., 50., 150.}) {
      for (const double hand_stiffness : {200., 500., 1500.}) {
        for (const double hand_mass : {0., 0.2, 0.5}) {
          scene::EmulatedDevice config;
          config.hand.mass = hand_mass;
          config.hand.damping = 10;
          config.hand.stiffness = hand_stiffness;
          const Felt hand = felt(config, {normal.normalized(), stiffness, 0.006});
          const double series = 1 / (1 / stiffness + 1 / hand_stiffness);
          INFO("normal " << normal.transpose() << ", wall " << stiffness << " N/m, hand "
                         << hand_stiffness << " N/m, " << hand_mass << " kg");
          CHECK(hand.force == Approx(series * 0.006).epsilon(0.1));
          CHECK(hand.step < std::max(0.05, 0.05 * hand.force));
          CHECK(hand.energy >= 0);
        }
      }
    }
  }
}

namespace {

/// What keeps a force from a hand for a while: its driver says nothing, or nobody tells laws.
enum class Silent { kDriver, kLaws };

/// A hand that is a mass on a spring and a damper, and whose driver says poses and velocities as
/// they are, presses a wall; from 1 s to 1.3 s something is silent, and at 4 s it draws back.
struct ExactHand {
  static constexpr double kMass = 0.1, kStiffness = 200, kDamping = 2.2, kWall = 60;
  double target = -0.006, z = 0, speed = 0;
  HapticRenderer renderer{scene::Haptics{}, kTick};
  DeviceSample heard;
  RenderedForce out;

  void tick(int i, std::optional<Silent> silent) {
    const double time = kTick * i;
    if (silent == Silent::kDriver) {
      heard.silence += kTick;
    } else {
      heard.pose.position = Vec3(0, 0, z);
      heard.twist.linear = Vec3(0, 0, speed);
      heard.silence = 0;
    }
    heard.delay = 0;
    LocalLaw law = testing::wall_law(heard.pose.position, kWall);
    law.period = 4 * kTick;
    if (i % 4 == 0 && silent != Silent::kLaws) renderer.update_law(law, time);
    renderer.tick(time, heard, out);
    for (int k = 0; k < 10; ++k) {
      const double force = out.force.z() + kStiffness * (target - z) - kDamping * speed;
      speed += force / kMass * kTick / 10;
      z += speed * kTick / 10;
    }
  }
};

}  // namespace

TEST_CASE("resting hand: it rests again after a silence, however exactly it is read, unpulled") {
  // Oracle: two springs in series, within a tenth; a step of 0.05 N is not felt; tissue pushes. A
  // controller that takes all of a push from whoever moves shakes this hand for ever.
  for (const Silent what : {Silent::kDriver, Silent::kLaws}) {
    ExactHand hand;
    double step = 0, least = 1;
    for (int i = 0; i < 6000; ++i) {
      const bool is_silent = i >= 1000 && i < 1300;
      if (i >= 4000) hand.target = -0.006 + 0.03 * kTick * (i - 4000);
      const double before = hand.out.force.z();
      hand.tick(i, is_silent ? std::optional(what) : std::nullopt);
      if (i >= 2500 && i < 4000) step = std::max(step, std::abs(hand.out.force.z() - before));
      least = std::min(least, hand.out.force.z());
      const double series = 1 / (1 / ExactHand::kWall + 1 / ExactHand::kStiffness);
      if (i == 999 || i == 3999) CHECK(hand.out.force.z() == Approx(series * 0.006).epsilon(0.1));
    }
    INFO((what == Silent::kDriver ? "driver" : "laws") << " silent");
    CHECK(step < 0.01);
    CHECK(least > -0.01);
  }
}
