// A hand at rest around which an elastic wall appears, with a device that reads in encoder steps.
#include <algorithm>
#include <catch2/catch.hpp>

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
