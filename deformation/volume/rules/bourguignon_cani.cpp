#include "deformation/volume/rules/bourguignon_cani.h"

#include <cmath>
#include <numeric>

#include "deformation/volume/rules/explicit_step.h"
namespace palpate::deformation {

BourguignonCani::BourguignonCani(const OrganModel& model) : model_(model) {
  const auto& areas = model.network().node_areas;
  rest_area_ = std::accumulate(areas.begin(), areas.end(), 0.0);
  for (const double area : areas) shares_.push_back(area / rest_area_);
  rest_distance_ = evaluate(model.rest_positions);
  stiffness_ = 3 * kModulus * rest_area_ / rest_distance_;
  // The Hessian at rest is k u uᵀ: of rank one.
  double squared = 0;
  for (std::size_t j = 0; j < directions_.size(); ++j) {
    squared += stiffness_ * directions_[j].squaredNorm() * model.inverse_masses[j];
  }
  largest_step_ = largest_explicit_step(model, squared);
}

Vec3 BourguignonCani::barycentre(const std::vector<Vec3>& positions) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t j = 0; j < shares_.size(); ++j) sum += shares_[j] * positions[j];
  return sum;
}

double BourguignonCani::mean_distance(const std::vector<Vec3>& positions) const {
  const Vec3 x_B = barycentre(positions);
  double sum = 0;
  for (std::size_t j = 0; j < shares_.size(); ++j) sum += shares_[j] * (positions[j] - x_B).norm();
  return sum;
}

double BourguignonCani::evaluate(const std::vector<Vec3>& positions) {
  const Vec3 x_B = barycentre(positions);
  Vec3 reaction = Vec3::Zero();
  double distance = 0;
  directions_.assign(shares_.size(), Vec3::Zero());
  for (std::size_t j = 0; j < shares_.size(); ++j) {
    const Vec3 from = positions[j] - x_B;
    const double length = from.norm();
    if (length == 0) continue;
    directions_[j] = (shares_[j] / length) * from;
    reaction += directions_[j];
    distance += shares_[j] * length;
  }
  for (std::size_t j = 0; j < shares_.size(); ++j) directions_[j] -= shares_[j] * reaction;
  return distance;
}

double BourguignonCani::target_distance(const OrganState& state) const {
  return rest_distance_ * std::cbrt(state.target_volume / model_.rest_volume);
}

double BourguignonCani::stored_energy(const OrganState& state) const {
  const double error = mean_distance(state.positions) - target_distance(state);
  return 0.5 * stiffness_ * error * error;
}

VolumeAction BourguignonCani::before_contacts(double h, const OrganState& state, FreeStep& step) {
  const double distance = evaluate(state.positions);
  const double force = stiffness_ * (target_distance(state) - distance);
  add_along_gradient(model_, directions_, h * force, step.velocities);
  return {.pressure = force / rest_area_};
}

}  // namespace palpate::deformation
