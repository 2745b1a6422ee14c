// A ball that a finger touches from above, and walls, for tests of certificates.
#pragma once

#include <algorithm>
#include <cmath>

#include "haptics/haptic_renderer.h"
#include "studies/certify/loop.h"
#include "tests/palpate/ball_scene.h"

namespace palpate::testing {

inline const std::function<void()> kGoOn = [] {};

/// Down onto the ball's top: at 1 s it is 1 cm deep.
inline constexpr const char* kFingerFromAbove =
    "scripted: {start_m: [0, 0, 0.09], moves: [{to_m: [0, 0, 0.05], duration_s: 1}]}";

/// For walls: no organ, a Touch-class device.
inline certify::Subject wall_subject() {
  certify::Subject subject;
  subject.scene.probes.push_back({"tip", scene::SphereShape{}, 0, scene::ScriptedDevice{}});
  return subject;
}

/// What contact damping takes from a motion along the force [J]. Where it is a part of the force,
/// that is of the tissue's: the motors' is larger by it on the way in, smaller on the way out.
inline double taken_by_damping(const std::vector<certify::Tick>& ticks, double period) {
  using haptics::HapticRenderer;
  double sum = 0;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const double moved = ticks[i].depth - ticks[i - 1].depth;
    const double most = HapticRenderer::kMostDamped;
    const double part = most / (moved > 0 ? 1 + most : 1 - most);
    sum += std::min(HapticRenderer::kContactDamping * std::abs(moved) / period,
                    part * std::max(0.0, ticks[i].motor)) *
           std::abs(moved);
  }
  return sum;
}

}  // namespace palpate::testing
