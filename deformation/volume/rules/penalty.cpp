#include "deformation/volume/rules/penalty.h"

namespace palpate::deformation {

Penalty::Penalty(const OrganModel& model, double modulus)
    : model_(model),
      modulus_(modulus),
      largest_step_(
          largest_explicit_step(model, modulus * model.rest_denominator / model.rest_volume)),
      kernel_(model) {}

double Penalty::stored_energy(const OrganState& state) const {
  const double error =
      geometry::enclosed_volume(state.positions, model_.triangles) - state.target_volume;
  return 0.5 * modulus_ * error * error / state.target_volume;
}

StepReport Penalty::step(double h, std::span<ContactRow> rows, OrganState& state) {
  // 1. springs, damping, drag, gravity; the volume
  kernel_.free_step(h, state, free_);

  // 2. pressure of the volume lost
  state.pressure = modulus_ * (state.target_volume - free_.volume.volume) / state.target_volume;
  add_along_gradient(model_, free_.volume.gradient, h * state.pressure, free_.velocities);

  // 3. contacts; 4. positions
  solve_contacts(model_, nullptr, 0, h, rows, free_.velocities);
  kernel_.finish_step(h, 0, free_, state);
  return {};
}

}  // namespace palpate::deformation
