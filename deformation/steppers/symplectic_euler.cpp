#include "deformation/steppers/symplectic_euler.h"

#include <cmath>

#include "deformation/springs/spring_forces.h"

namespace palpate::deformation {

void apply_forces(const OrganModel& model, double h, OrganState& state, std::vector<Vec3>& forces) {
  forces.assign(model.node_count(), Vec3::Zero());
  add_spring_forces(model.network(), state, forces);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3 acceleration = model.inverse_masses[i] * forces[i] + model.gravity;
    const Vec3 velocity =
        state.velocities[i] + h * (acceleration - model.drag * state.velocities[i]);
    state.velocities[i] = model.inverse_masses[i] > 0 ? velocity : Vec3::Zero();
  }
}

void correct_volume(const OrganModel& model, double h, std::span<ContactRow> rows,
                    OrganState& state, StepBuffers& buffers, ContactSolveReport& report) {
  evaluate_volume(model, state.positions, buffers.volume);
  // Φ(q⁺) + h g·Δv = 0, written for v⁺ + Δv as the solver wants it.
  double rate = (buffers.volume.volume - state.target_volume) / h;
  for (std::size_t i = 0; i < buffers.volume.gradient.size(); ++i) {
    rate -= buffers.volume.gradient[i].dot(state.velocities[i]);
  }
  const VolumeRow volume{buffers.volume, rate};
  buffers.velocities = state.velocities;
  const auto correction =
      solve_contacts_and_volume(model, &volume, h, rows, state.velocities, WarmStart::kApplied);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    state.positions[i] += h * (state.velocities[i] - buffers.velocities[i]);
  }
  report.volume_impulse += correction.volume_impulse;
  report.sweeps += correction.sweeps;
  report.volume_skipped |= correction.volume_skipped;
}

ContactSolveReport symplectic_euler_step(const OrganModel& model, double h,
                                         std::span<ContactRow> rows, OrganState& state,
                                         StepBuffers& buffers, const KeptVolume& kept) {
  // 1. springs, damping, drag, gravity → unconstrained velocities
  apply_forces(model, h, state, buffers.forces);

  // 2. volume and its gradient at the old positions: Φ = V − V*
  evaluate_volume(model, state.positions, buffers.volume);
  const VolumeRow volume{buffers.volume, (buffers.volume.volume - state.target_volume) / h};

  // 3. contact impulses and the one volume multiplier → velocities at the end of the step
  auto report =
      solve_contacts_and_volume(model, kept.is_kept ? &volume : nullptr, h, rows, state.velocities);

  // 4. positions
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    state.positions[i] += h * state.velocities[i];
  }

  // 5. what the linearisation left
  for (int k = 0; kept.is_kept && k < kept.corrections; ++k) {
    correct_volume(model, h, rows, state, buffers, report);
  }
  state.pressure = -report.volume_impulse / h;
  return report;
}

SymplecticEuler::SymplecticEuler(const OrganModel& model, std::unique_ptr<VolumeRule> rule,
                                 ChunkRunner* runner)
    : model_(model),
      rule_(std::move(rule)),
      kernel_(model, model.network(), rule_->reads_gradient(), runner) {}

StepReport SymplecticEuler::step(double h, std::span<ContactRow> rows, OrganState& state) {
  // 1. springs, damping, drag, gravity; volume and its gradient; what the rule makes of them
  kernel_.free_step(h, state, free_);
  const VolumeAction action = rule_->before_contacts(h, state, free_);

  // 2. contact impulses and the one volume multiplier
  const VolumeRow volume{free_.volume, action.rate.value_or(0)};
  auto report = solve_contacts(model_, action.rate ? &volume : nullptr, free_.volume_velocity, h,
                               rows, free_.velocities);
  if (std::abs(report.volume_impulse) > h * state.pressure_limit) {
    push_with(std::copysign(h * state.pressure_limit, report.volume_impulse), h, rows, state);
    return {.pressure_capped = true};
  }

  // 3. velocities at the end of the step, positions
  const int corrections = rule_->corrections();
  if (corrections > 0) start_ = state.positions;
  kernel_.finish_step(h, report.volume_impulse, free_, state);

  // 4. what the linearisation left
  for (int k = 0; k < corrections; ++k) correct_volume(h, rows, state, report);
  state.pressure = action.pressure.value_or(-report.volume_impulse / h);
  if (rule_->reads_end_gradient()) kernel_.evaluate_volume(state.positions, free_);
  const bool corrected = rule_->after_step(h, free_.volume, state);
  return {.volume_skipped = action.skipped || report.volume_skipped || !corrected};
}

/// What the plain correct_volume() does, the step's end taken again from its start.
void SymplecticEuler::correct_volume(double h, std::span<ContactRow> rows, OrganState& state,
                                     ContactSolveReport& report) {
  free_.velocities = state.velocities;
  kernel_.evaluate_volume(state.positions, free_);
  const VolumeRow volume{free_.volume,
                         (free_.volume.volume - state.target_volume) / h - free_.volume_velocity};
  const auto correction = solve_contacts(model_, &volume, free_.volume_velocity, h, rows,
                                         free_.velocities, WarmStart::kApplied);
  state.positions = start_;
  kernel_.finish_step(h, correction.volume_impulse, free_, state);
  report.volume_impulse += correction.volume_impulse;
  report.volume_skipped |= correction.volume_skipped;
}

/// The step with a given impulse of the contents, to which contacts are found anew.
void SymplecticEuler::push_with(double volume_impulse, double h, std::span<ContactRow> rows,
                                OrganState& state) {
  kernel_.free_step(h, state, free_);
  const auto& gradient = free_.volume.gradient;
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    free_.velocities[i] -= model_.inverse_masses[i] * volume_impulse * gradient[i];
  }
  solve_contacts(model_, nullptr, 0, h, rows, free_.velocities);
  kernel_.finish_step(h, 0, free_, state);
  state.pressure = -volume_impulse / h;
}

}  // namespace palpate::deformation
