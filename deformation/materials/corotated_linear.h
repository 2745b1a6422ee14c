// Linear elasticity in a frame that turns with the tissue, F = R S:
//   ψ(F) = μ ‖F − R‖² + λ/2 (tr RᵀF − 3)²
//   P = 2μ (F − R) + λ (tr RᵀF − 3) R
// M. Müller, M. Gross, "Interactive Virtual Materials", Graphics Interface 2004. Stresses are
// linear in the strain, and wrong by about as much as that is. Of tissue turned inside out R is the
// nearest rotation with det R = 1, and stresses turn it back.
#pragma once

#include "deformation/materials/constitutive_law.h"

namespace palpate::deformation {

struct CorotatedLinear {
  /// @param tissue  ν < 1/2
  explicit CorotatedLinear(const ElasticConstants& tissue)
      : shear_modulus(tissue.shear_modulus()), lambda(tissue.lame_lambda()) {}

  double energy_density(const Mat3& F) const;
  Mat3 first_piola_stress(const Mat3& F) const;
  /// Of F where the nearest rotation is unique.
  Mat9 stress_derivative(const Mat3& F) const;

  /// P of F with the nearest rotation R at hand. The derivative with R held,
  /// 2μ 1 + λ R ⊗ R, is positive definite: what implicit steps take for ∂P/∂F.
  Mat3 first_piola_stress(const Mat3& F, const Mat3& R) const {
    return 2 * shear_modulus * F + (lambda * (R.cwiseProduct(F).sum() - 3) - 2 * shear_modulus) * R;
  }

  double shear_modulus, lambda;  ///< Lamé's parameters μ, λ [Pa]
};

static_assert(ConstitutiveLaw<CorotatedLinear>);

}  // namespace palpate::deformation
