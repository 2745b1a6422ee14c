// A haptic renderer on a wall, ticked by hand.
#pragma once

#include "haptics/haptic_renderer.h"
#include "tests/haptics/wall_law.h"

namespace palpate::testing {

using haptics::DeviceSample;
using haptics::HapticRenderer;

inline constexpr double kT = 1e-3;

inline LocalLaw wall_model(const Vec3& anchor, double stiffness = 200) {
  LocalLaw law = wall_law(anchor, stiffness);
  law.validity_radius = 0.01;
  law.period = 4 * kT;
  law.rows[0].point_P = Vec3(0, 0.01, 0);  // torque about x
  return law;
}

inline DeviceSample resting_at(const Vec3& position) {
  DeviceSample sample;
  sample.pose.position = position;
  return sample;
}

/// A renderer with its clock; keeps the model fresh every 4th tick while `fresh`.
struct RendererBench {
  explicit RendererBench(const scene::Haptics& limits = {}) : renderer(limits, kT) {}

  RenderedForce tick(const DeviceSample& device) {
    RenderedForce out;
    renderer.tick(time(), device, out);
    ++ticks;
    return out;
  }
  RenderedForce hold(const LocalLaw& model, const DeviceSample& device, int count) {
    RenderedForce out;
    for (int i = 0; i < count; ++i) {
      if (i % 4 == 0) renderer.update_law(model, time());
      out = tick(device);
    }
    return out;
  }
  double time() const { return kT * ticks; }

  HapticRenderer renderer;
  int ticks = 0;
};

inline const Vec3 kPressed(0, 0, -0.01);  ///< 2 N

}  // namespace palpate::testing
