// A ball between two rigid plates, one contact row per node: for tests that look at every step.
#pragma once

#include <algorithm>
#include <cmath>

#include "studies/rigs/squeezed_ball.h"

namespace palpate::deformation::testing {

using rigs::Plates;

struct SqueezeErrors {
  double peak = 0, held = 0;  ///< largest |V−V*|/V* while moving, and in the last half second
};

/// Squeezes from `plates.height()` by `compression` in `seconds` and holds for `hold` ≥ 0.5 s.
inline SqueezeErrors squeeze(const OrganModel& model, OrganDynamics& dynamics, double h,
                             double compression, double seconds, double hold, Plates& plates,
                             OrganState& state) {
  SqueezeErrors errors;
  const double start = plates.height();
  const int moving = static_cast<int>(std::ceil(seconds / h));
  const int last = moving + static_cast<int>(std::ceil(hold / h));
  for (int s = 1; s <= last; ++s) {
    const double part = rigs::minimum_jerk(static_cast<double>(s) / moving);
    plates.step(dynamics, h, start * (1 - compression * part), state);
    const double volume = geometry::enclosed_volume(state.positions, model.triangles);
    const double error = std::abs(volume / state.target_volume - 1);
    double& worst = s * h > seconds + hold - 0.5 ? errors.held : errors.peak;
    worst = std::max(worst, error);
  }
  return errors;
}

}  // namespace palpate::deformation::testing
