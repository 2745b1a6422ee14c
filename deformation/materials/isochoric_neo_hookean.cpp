#include "deformation/materials/isochoric_neo_hookean.h"

#include <Eigen/LU>
#include <cmath>

#include "deformation/materials/volume_ratio.h"

namespace palpate::deformation {

double IsochoricNeoHookean::energy_density(const Mat3& F) const {
  return shear_modulus / 2 * (F.squaredNorm() / std::cbrt(F.determinant() * F.determinant()) - 3);
}

// P = μ J^(−2/3) (F − (tr FᵀF / 3) F⁻ᵀ)
Mat3 IsochoricNeoHookean::first_piola_stress(const Mat3& F) const {
  const double J = F.determinant();
  const Mat3 inverse_transpose = cofactor(F) / J;
  return shear_modulus / std::cbrt(J * J) * (F - F.squaredNorm() / 3 * inverse_transpose);
}

// With G = F⁻ᵀ and I = tr FᵀF:
//   ∂P_ij/∂F_kl = μ J^(−2/3) (δ_ik δ_jl − ⅔ (F_ij G_kl + G_ij F_kl) + (2/9) I G_ij G_kl
//                              + ⅓ I G_il G_kj)
Mat9 IsochoricNeoHookean::stress_derivative(const Mat3& F) const {
  const double J = F.determinant(), I = F.squaredNorm();
  const Mat3 G = cofactor(F) / J;
  const Eigen::Map<const Eigen::Matrix<double, 9, 1>> f(F.data()), g(G.data());
  Mat9 stiffness = Mat9::Identity();
  stiffness.noalias() -= 2.0 / 3 * (f * g.transpose() + g * f.transpose());
  stiffness.noalias() += 2.0 / 9 * I * g * g.transpose();
  for (int l = 0; l < 3; ++l) {
    for (int j = 0; j < 3; ++j) {
      stiffness.block<3, 3>(3 * j, 3 * l).noalias() += I / 3 * G.col(l) * G.col(j).transpose();
    }
  }
  return shear_modulus / std::cbrt(J * J) * stiffness;
}

}  // namespace palpate::deformation
