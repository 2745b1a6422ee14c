// Neo-Hookean tissue without the part that resists a change of volume:
//   ψ(F) = μ/2 (J^(−2/3) tr FᵀF − 3)
// The volumetric part κ/2 (J − 1)² belongs to the pressure unknown of elements/taylor_hood.h:
//   κ/2 (J − 1)² = max over p of p (J − 1) − p²/(2κ)
#pragma once

#include "deformation/materials/constitutive_law.h"

namespace palpate::deformation {

struct IsochoricNeoHookean {
  explicit IsochoricNeoHookean(const ElasticConstants& tissue)
      : shear_modulus(tissue.shear_modulus()) {}

  /// All for J > 0.
  double energy_density(const Mat3& F) const;
  Mat3 first_piola_stress(const Mat3& F) const;
  Mat9 stress_derivative(const Mat3& F) const;

  double shear_modulus;  ///< μ [Pa]
};

static_assert(ConstitutiveLaw<IsochoricNeoHookean>);

}  // namespace palpate::deformation
