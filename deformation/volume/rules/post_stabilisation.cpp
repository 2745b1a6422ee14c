#include "deformation/volume/rules/post_stabilisation.h"

namespace palpate::deformation {

PostStabilisation::PostStabilisation(const OrganModel& model)
    : model_(model), largest_step_(largest_explicit_step(model, 0)), kernel_(model) {}

StepReport PostStabilisation::step(double h, std::span<ContactRow> rows, OrganState& state) {
  // 1. springs, damping, drag, gravity
  kernel_.free_step(h, state, free_);

  // 2. contacts and g·v⁺ = 0; 3. positions
  const VolumeRow row{free_.volume, 0};
  const auto report =
      solve_contacts(model_, &row, free_.volume_velocity, h, rows, free_.velocities);
  kernel_.finish_step(h, report.volume_impulse, free_, state);
  state.pressure = -report.volume_impulse / h;

  // 4. back to V*
  kernel_.evaluate_volume(state.positions, free_);
  const VolumeGradient& end = free_.volume;
  if (has_vanished(model_, end)) return {.volume_skipped = true};
  const double error = end.volume - state.target_volume;
  add_along_gradient(model_, end.gradient, -error / end.denominator, state.positions);
  return {report.volume_skipped};
}

}  // namespace palpate::deformation
