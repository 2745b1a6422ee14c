#include "deformation/volume/rules/baumgarte.h"

#include <algorithm>
#include <cmath>

#include "deformation/volume/rules/explicit_step.h"
#include "deformation/volume/rules/volume_along_line.h"

namespace palpate::deformation {

double Baumgarte::law_step_bound() { return 2 * (std::sqrt(kA * kA + kB * kB) - kA) / (kB * kB); }

Baumgarte::Baumgarte(const OrganModel& model)
    : model_(model),
      largest_step_(
          std::min(largest_explicit_step(model, 0), kExplicitStepSafety * law_step_bound())) {}

VolumeAction Baumgarte::before_contacts(double h, const OrganState& state, FreeStep&) {
  // Φ, Φ̇ and ġ·v at the step's start
  const auto [volume, volume_rate, half_curvature, unused] =
      volume_along_line(model_.triangles, state.positions, state.velocities);
  const double error = volume - state.target_volume;
  const double asked = 2 * half_curvature + 2 * kA * volume_rate + kB * kB * error;
  return {.rate = h * asked - volume_rate};
}

}  // namespace palpate::deformation
