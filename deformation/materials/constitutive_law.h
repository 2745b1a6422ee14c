// What every constitutive law of hyperelastic tissue answers. All are functions of the deformation
// gradient F = ∂x/∂X, per volume at rest. tests/deformation/materials/constitutive_laws_test.cpp
// holds each law to what follows from these words.
#pragma once

#include <Eigen/Core>
#include <concepts>

#include "deformation/materials/elastic_constants.h"
#include "modules/core/types.h"

namespace palpate::deformation {

/// A 3×3 matrix A is the 9-vector of its columns: index i + 3 k is A(i, k).
using Mat9 = Eigen::Matrix<double, 9, 9>;

template <class Law>
concept ConstitutiveLaw = requires(const Law& law, const Mat3& F, const ElasticConstants& tissue) {
  Law(tissue);
  { law.energy_density(F) } -> std::same_as<double>;    // ψ, 0 at rest [J/m³]
  { law.first_piola_stress(F) } -> std::same_as<Mat3>;  // P = ∂ψ/∂F [Pa]
  { law.stress_derivative(F) } -> std::same_as<Mat9>;   // ∂P/∂F [Pa]
};

}  // namespace palpate::deformation
