#include "deformation/materials/stable_neo_hookean.h"

#include <Eigen/LU>

#include "deformation/materials/volume_ratio.h"

namespace palpate::deformation {

double StableNeoHookean::energy_density(const Mat3& F) const {
  return energy_density(F.squaredNorm(), F.determinant());
}

// P = μ F + ∂ψ/∂J ∂J/∂F
Mat3 StableNeoHookean::first_piola_stress(const Mat3& F) const {
  return shear_modulus * F + volume_derivative(F.determinant()) * cofactor(F);
}

// ∂P/∂F = μ 1 + λ̂ ∂J/∂F ⊗ ∂J/∂F + ∂ψ/∂J ∂²J/∂F²
Mat9 StableNeoHookean::stress_derivative(const Mat3& F) const {
  const Mat3 G = cofactor(F);
  const Eigen::Map<const Eigen::Matrix<double, 9, 1>> g(G.data());
  return shear_modulus * Mat9::Identity() + volume_modulus * g * g.transpose() +
         volume_derivative(F.determinant()) * cofactor_derivative(F);
}

}  // namespace palpate::deformation
