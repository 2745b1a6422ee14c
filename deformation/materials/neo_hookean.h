// Neo-Hookean tissue, shape and volume apart:
//   ψ(F) = μ/2 (J^(−2/3) tr FᵀF − 3) + κ/2 (J − 1)²
// Here the first part only. The second is carried by the pressure unknown of mixed_solid.h:
//   κ/2 (J − 1)² = max over p of p (J − 1) − p²/(2κ)
#pragma once

#include <Eigen/Core>

#include "modules/core/types.h"

namespace palpate::elements {

using Mat9 = Eigen::Matrix<double, 9, 9>;

/// A 3×3 matrix A is the 9-vector of its columns: index i + 3 k is A(i, k).
struct NeoHookean {
  double shear_modulus = 0;      ///< μ > 0 [Pa]
  double volume_compliance = 0;  ///< 1/κ ≥ 0; 0: incompressible [1/Pa]

  /// μ = E/(2(1+ν)), 1/κ = 3(1−2ν)/E.
  /// @param youngs_modulus  E > 0 [Pa]
  /// @param poissons_ratio  ν, 0 … 0.5, both included
  /// @throws InputError for other values
  static NeoHookean from_engineering(double youngs_modulus, double poissons_ratio);
};

/// μ/2 (J^(−2/3) tr FᵀF − 3) [J/m³]. @param F  J > 0
double shape_energy(double shear_modulus, const Mat3& F);
/// P = ∂/∂F of it [Pa].
Mat3 shape_stress(double shear_modulus, const Mat3& F);
/// ∂P/∂F [Pa].
Mat9 shape_stiffness(double shear_modulus, const Mat3& F);

/// ∂J/∂F = J F⁻ᵀ.
Mat3 cofactor(const Mat3& F);
/// ∂²J/∂F².
Mat9 cofactor_derivative(const Mat3& F);

}  // namespace palpate::elements
