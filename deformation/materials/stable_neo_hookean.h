// Neo-Hookean tissue whose energy is a polynomial: finite when flat or inside out.
//   ψ(F) = μ/2 (tr FᵀF − 3) − μ (J − 1) + λ̂/2 (J − 1)²
//        = μ/2 (tr FᵀF − 3) + λ̂/2 (J − 1 − μ/λ̂)² − μ²/(2λ̂)
//   B. Smith, F. de Goes, T. Kim, "Stable Neo-Hookean Flesh Simulation", ACM Trans. Graph. 37, 2018
// For small strain it is linear elasticity with Lamé's parameters μ and λ = λ̂ − μ.
#pragma once

#include "deformation/materials/constitutive_law.h"

namespace palpate::deformation {

struct StableNeoHookean {
  /// λ̂ = λ + μ. @param tissue  ν < 1/2
  explicit StableNeoHookean(const ElasticConstants& tissue)
      : shear_modulus(tissue.shear_modulus()),
        volume_modulus(shear_modulus * (tissue.lambda_over_shear() + 1)) {}
  /// @param shear, volume  μ, λ̂ > 0 [Pa]
  StableNeoHookean(double shear, double volume) : shear_modulus(shear), volume_modulus(volume) {}

  double energy_density(const Mat3& F) const;
  Mat3 first_piola_stress(const Mat3& F) const;
  Mat9 stress_derivative(const Mat3& F) const;

  /// ψ of tr FᵀF and J, for elements that know a volume better than det F.
  double energy_density(double squared_norm, double J) const {
    const double change = J - 1;
    return shear_modulus / 2 * (squared_norm - 3) - shear_modulus * change +
           volume_modulus / 2 * change * change;
  }
  /// ∂ψ/∂J [Pa]
  double volume_derivative(double J) const { return volume_modulus * (J - 1) - shear_modulus; }

  double shear_modulus, volume_modulus;  ///< μ, λ̂ [Pa]
};

static_assert(ConstitutiveLaw<StableNeoHookean>);

}  // namespace palpate::deformation
