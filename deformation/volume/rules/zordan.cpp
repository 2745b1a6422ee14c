#include "deformation/volume/rules/zordan.h"

#include <algorithm>

#include "deformation/volume/rules/explicit_step.h"
namespace palpate::deformation {

Zordan::Zordan(const OrganModel& model) : model_(model), pyramids_(build_pyramids(model)) {
  largest_step_ = largest_explicit_step(model, squared_frequency_bound());
}

double Zordan::stiffness(const Pyramid& pyramid) const {
  return kModulus / (pyramid.area_share * model_.rest_volume);
}

double Zordan::squared_frequency_bound() const {
  // Row i of M⁻¹ Σ_t k_t g_t g_tᵀ, block norms: Σ_t k_t ‖g_ti‖ Σ_j ‖g_tj‖ / m_i.
  std::vector<double> rows(model_.node_count(), 0);
  for (const Pyramid& pyramid : pyramids_) {
    const auto at_rest = evaluate_pyramid(pyramid, model_.rest_positions);
    double sum = 0;
    for (const Vec3& g : at_rest.gradient) sum += g.norm();
    for (std::size_t k = 0; k < 4; ++k) {
      rows[pyramid.nodes[k]] += stiffness(pyramid) * at_rest.gradient[k].norm() * sum;
    }
  }
  double bound = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    bound = std::max(bound, rows[i] * model_.inverse_masses[i]);
  }
  return bound;
}

double Zordan::stored_energy(const OrganState& state) const {
  const double filling = state.target_volume / model_.rest_volume;
  double energy = 0;
  for (const Pyramid& pyramid : pyramids_) {
    const double lost =
        filling * pyramid.rest_volume - evaluate_pyramid(pyramid, state.positions).volume;
    energy += 0.5 * stiffness(pyramid) * lost * lost;
  }
  return energy;
}

VolumeAction Zordan::before_contacts(double h, const OrganState& state, FreeStep& step) {
  const double filling = state.target_volume / model_.rest_volume;
  double mean_pressure = 0;
  for (const Pyramid& pyramid : pyramids_) {
    const auto at = evaluate_pyramid(pyramid, state.positions);
    const double pressure = stiffness(pyramid) * (filling * pyramid.rest_volume - at.volume);
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t node = pyramid.nodes[k];
      step.velocities[node] += (h * pressure * model_.inverse_masses[node]) * at.gradient[k];
    }
    mean_pressure += pyramid.area_share * pressure;
  }
  return {.pressure = mean_pressure};
}

}  // namespace palpate::deformation
