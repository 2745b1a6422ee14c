#include "deformation/volume/rules/promayon.h"

#include "deformation/volume/rules/explicit_step.h"
#include "deformation/volume/rules/volume_along_line.h"

namespace palpate::deformation {

Promayon::Promayon(const OrganModel& model)
    : model_(model), largest_step_(largest_explicit_step(model, 0)) {}

VolumeAction Promayon::before_contacts(double, const OrganState&, FreeStep&) { return {}; }

bool Promayon::after_step(double h, const VolumeGradient&, OrganState& state) {
  // Along d = M⁻¹g(x̂), as far as V* asks.
  evaluate_volume(model_, state.positions, end_);
  directions_.assign(model_.surface_node_count, Vec3::Zero());
  add_along_gradient(model_, end_.gradient, 1, directions_);
  auto cubic = volume_along_line(model_.triangles, state.positions, directions_);
  cubic[0] -= state.target_volume;
  const auto alpha = has_vanished(model_, end_) ? std::nullopt : nearest_root(cubic);
  for (std::size_t i = 0; alpha && i < directions_.size(); ++i) {
    state.positions[i] += *alpha * directions_[i];
    state.velocities[i] += (*alpha / h) * directions_[i];
  }
  state.pressure = alpha.value_or(0) / (h * h);
  return alpha.has_value();
}

}  // namespace palpate::deformation
