#include "deformation/volume/rules/penalty.h"

#include "deformation/volume/rules/explicit_step.h"
namespace palpate::deformation {

Penalty::Penalty(const OrganModel& model, double modulus)
    : model_(model),
      modulus_(modulus),
      largest_step_(
          largest_explicit_step(model, modulus * model.rest_denominator / model.rest_volume)) {}

double Penalty::stored_energy(const OrganState& state) const {
  const double error =
      geometry::enclosed_volume(state.positions, model_.triangles) - state.target_volume;
  return 0.5 * modulus_ * error * error / state.target_volume;
}

VolumeAction Penalty::before_contacts(double h, const OrganState& state, FreeStep& step) {
  const double pressure =
      modulus_ * (state.target_volume - step.volume.volume) / state.target_volume;
  add_along_gradient(model_, step.volume.gradient, h * pressure, step.velocities);
  return {.pressure = pressure};
}

}  // namespace palpate::deformation
