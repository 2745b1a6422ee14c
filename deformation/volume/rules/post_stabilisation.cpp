#include "deformation/volume/rules/post_stabilisation.h"

#include "deformation/volume/rules/explicit_step.h"
namespace palpate::deformation {

PostStabilisation::PostStabilisation(const OrganModel& model)
    : model_(model), largest_step_(largest_explicit_step(model, 0)) {}

VolumeAction PostStabilisation::before_contacts(double, const OrganState&, FreeStep&) {
  return {.rate = 0};  // g·v⁺ = 0
}

bool PostStabilisation::after_step(double, const VolumeGradient& end, OrganState& state) {
  if (has_vanished(model_, end)) return false;
  const double error = end.volume - state.target_volume;
  add_along_gradient(model_, end.gradient, -error / end.denominator, state.positions);
  return true;
}

}  // namespace palpate::deformation
