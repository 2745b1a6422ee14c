#include "deformation/volume/rules/element_volume.h"

#include "deformation/volume/rules/explicit_step.h"
namespace palpate::deformation {

ElementVolume::ElementVolume(const OrganModel& model)
    : model_(model),
      pyramids_(build_pyramids(model)),
      largest_step_(largest_explicit_step(model, 0)),
      constraints_(pyramids_.size()) {
  for (const Pyramid& pyramid : pyramids_) {
    mean_denominator_ +=
        inverse_mass_along(pyramid, evaluate_pyramid(pyramid, model.rest_positions));
  }
  mean_denominator_ /= static_cast<double>(pyramids_.size());
}

double ElementVolume::inverse_mass_along(const Pyramid& pyramid, const PyramidVolume& at) const {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    sum += at.gradient[k].squaredNorm() * model_.inverse_masses[pyramid.nodes[k]];
  }
  return sum;
}

bool ElementVolume::prepare(double h, const OrganState& state) {
  const double filling = state.target_volume / model_.rest_volume;
  bool all = true;
  for (std::size_t t = 0; t < pyramids_.size(); ++t) {
    Constraint& constraint = constraints_[t];
    constraint.at = evaluate_pyramid(pyramids_[t], state.positions);
    constraint.rate = (constraint.at.volume - filling * pyramids_[t].rest_volume) / h;
    constraint.denominator = inverse_mass_along(pyramids_[t], constraint.at);
    constraint.impulse = 0;
    all &= constraint.denominator > kVanishedDenominator * mean_denominator_;
  }
  return all;
}

void ElementVolume::relax(std::size_t t, std::vector<Vec3>& velocities) {
  Constraint& constraint = constraints_[t];
  if (!(constraint.denominator > kVanishedDenominator * mean_denominator_)) return;
  const auto& nodes = pyramids_[t].nodes;
  double rate = constraint.rate;
  for (std::size_t k = 0; k < 4; ++k) {
    rate += constraint.at.gradient[k].dot(velocities[nodes[k]]);
  }
  const double impulse = rate / constraint.denominator;
  constraint.impulse += impulse;
  for (std::size_t k = 0; k < 4; ++k) {
    velocities[nodes[k]] -= (impulse * model_.inverse_masses[nodes[k]]) * constraint.at.gradient[k];
  }
}

VolumeAction ElementVolume::before_contacts(double h, const OrganState& state, FreeStep& step) {
  const bool all = prepare(h, state);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {  // forwards and backwards
    for (std::size_t t = 0; t < pyramids_.size(); ++t) {
      relax(sweep % 2 == 0 ? t : pyramids_.size() - 1 - t, step.velocities);
    }
  }
  double pressure = 0;
  for (std::size_t t = 0; t < pyramids_.size(); ++t) {
    pressure -= pyramids_[t].area_share * constraints_[t].impulse / h;
  }
  return {.pressure = pressure, .skipped = !all};
}

}  // namespace palpate::deformation
