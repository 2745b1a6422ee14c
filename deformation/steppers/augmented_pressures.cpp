#include "deformation/steppers/augmented_pressures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace palpate::deformation {
namespace {

bool are_remembered(const ElementPressures& pressures) {
  return pressures.count > 0 && pressures.modulus > 0;
}

}  // namespace

AugmentedPressures::AugmentedPressures(const Body& body) {
  using std::numbers::pi;
  const double radius = std::cbrt(3 * body.rest_volume / (4 * pi));
  density_ = std::accumulate(body.masses.begin(), body.masses.end(), 0.0) / body.rest_volume;
  squared_wave_number_ = pi * pi / (radius * radius) / 4;
}

double AugmentedPressures::share(double h, const ElementPressures& pressures) const {
  const double K = h * h * pressures.modulus * squared_wave_number_ / density_;
  const double least = kLeastOverShear * pressures.shear_modulus / pressures.modulus;
  return std::min(1.0, std::max(1 / (K + 2), least));
}

void AugmentedPressures::begin(double h, OrganState& state, ElasticForceElements& elements) {
  const ElementPressures pressures = elements.pressures();
  if (!are_remembered(pressures)) return;
  const auto count = static_cast<Eigen::Index>(pressures.count);
  Eigen::VectorXd &kept = state.internal.pressures, &of_shape = state.internal.shape_pressures;
  if (of_shape.size() != count) elements.take_pressures_of_shape(state.positions, of_shape);
  if (kept.size() != count) kept = of_shape;
  const double share = this->share(h, pressures);
  const Eigen::ArrayXd squared = (of_shape.array() / (kTame * pressures.modulus)).square();
  shares_ = 1 - (1 - share) / (1 + squared);
  go_on_from(kept, elements);
}

void AugmentedPressures::begin_evenly(double h, const OrganState& state,
                                      ElasticForceElements& elements) {
  const ElementPressures pressures = elements.pressures();
  const Eigen::VectorXd& kept = state.internal.pressures;
  if (!are_remembered(pressures) || kept.size() != shares_.size()) return;
  shares_.setConstant(share(h, pressures));
  go_on_from(kept, elements);
}

void AugmentedPressures::go_on_from(const Eigen::VectorXd& pressures,
                                    ElasticForceElements& elements) {
  kept_ = (1 - shares_.array()) * pressures.array();
  elements.go_on_from(kept_, shares_);
}

void AugmentedPressures::end(OrganState& state, ElasticForceElements& elements) {
  if (!are_remembered(elements.pressures())) return;
  Eigen::VectorXd& of_shape = state.internal.shape_pressures;
  elements.take_pressures_of_shape(state.positions, of_shape);
  state.internal.pressures = kept_ + shares_.cwiseProduct(of_shape);
}

}  // namespace palpate::deformation
