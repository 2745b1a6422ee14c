#include "deformation/volume/rules/baumgarte.h"

#include <algorithm>
#include <cmath>

#include "deformation/volume/rules/volume_along_line.h"

namespace palpate::deformation {

double Baumgarte::law_step_bound() { return 2 * (std::sqrt(kA * kA + kB * kB) - kA) / (kB * kB); }

Baumgarte::Baumgarte(const OrganModel& model)
    : model_(model),
      largest_step_(
          std::min(largest_explicit_step(model, 0), kExplicitStepSafety * law_step_bound())),
      kernel_(model) {}

StepReport Baumgarte::step(double h, std::span<ContactRow> rows, OrganState& state) {
  // 1. Φ, Φ̇ and ġ·v at the step's start
  const auto [volume, volume_rate, half_curvature, unused] =
      volume_along_line(model_.triangles, state.positions, state.velocities);
  const double error = volume - state.target_volume;
  const double asked = 2 * half_curvature + 2 * kA * volume_rate + kB * kB * error;

  // 2. springs, damping, drag, gravity
  kernel_.free_step(h, state, free_);

  // 3. contacts and the multiplier of the stabilised constraint; 4. positions
  const VolumeRow row{free_.volume, h * asked - volume_rate};
  const auto report =
      solve_contacts(model_, &row, free_.volume_velocity, h, rows, free_.velocities);
  kernel_.finish_step(h, report.volume_impulse, free_, state);
  state.pressure = -report.volume_impulse / h;
  return {report.volume_skipped};
}

}  // namespace palpate::deformation
