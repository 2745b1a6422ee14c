// The two constants of an isotropic elastic tissue, and all that follows from them.
#pragma once

namespace palpate::deformation {

class ElasticConstants {
 public:
  /// @param youngs_modulus  E > 0 [Pa]
  /// @param poisson_ratio   ν, 0 … 0.5, both included; 0.5 is incompressible
  /// @throws InputError for other values
  ElasticConstants(double youngs_modulus, double poisson_ratio);

  double youngs_modulus() const { return E_; }  ///< [Pa]
  double poisson_ratio() const { return nu_; }

  double shear_modulus() const { return E_ / (2 * (1 + nu_)); }  ///< μ [Pa]
  /// Lamé's first parameter λ [Pa]; infinite at ν = 1/2.
  double lame_lambda() const { return E_ * nu_ / ((1 + nu_) * (1 - 2 * nu_)); }
  /// λ/μ; infinite at ν = 1/2.
  double lambda_over_shear() const { return 2 * nu_ / (1 - 2 * nu_); }
  /// κ/μ; infinite at ν = 1/2.
  double bulk_over_shear() const { return 2 * (1 + nu_) / (3 * (1 - 2 * nu_)); }
  double inverse_bulk_modulus() const { return 3 * (1 - 2 * nu_) / E_; }  ///< 1/κ ≥ 0 [1/Pa]

 private:
  double E_, nu_;
};

}  // namespace palpate::deformation
