#include "deformation/materials/neo_hookean.h"

#include <Eigen/LU>
#include <cmath>
#include <string>

#include "modules/core/error.h"

namespace palpate::elements {

NeoHookean NeoHookean::from_engineering(double youngs_modulus, double poissons_ratio) {
  if (!(youngs_modulus > 0) || !std::isfinite(youngs_modulus)) {
    throw InputError("Young's modulus " + std::to_string(youngs_modulus) +
                     " Pa; allowed: greater than 0");
  }
  if (!(poissons_ratio >= 0 && poissons_ratio <= 0.5)) {
    throw InputError("Poisson's ratio " + std::to_string(poissons_ratio) + "; allowed: 0 to 0.5");
  }
  return {youngs_modulus / (2 * (1 + poissons_ratio)),
          3 * (1 - 2 * poissons_ratio) / youngs_modulus};
}

double shape_energy(double shear_modulus, const Mat3& F) {
  return shear_modulus / 2 * (F.squaredNorm() / std::cbrt(F.determinant() * F.determinant()) - 3);
}

// P = μ J^(−2/3) (F − (tr FᵀF / 3) F⁻ᵀ)
Mat3 shape_stress(double shear_modulus, const Mat3& F) {
  const double J = F.determinant();
  const Mat3 inverse_transpose = cofactor(F) / J;
  return shear_modulus / std::cbrt(J * J) * (F - F.squaredNorm() / 3 * inverse_transpose);
}

// With G = F⁻ᵀ and I = tr FᵀF:
//   ∂P_ij/∂F_kl = μ J^(−2/3) (δ_ik δ_jl − ⅔ (F_ij G_kl + G_ij F_kl) + (2/9) I G_ij G_kl
//                              + ⅓ I G_il G_kj)
Mat9 shape_stiffness(double shear_modulus, const Mat3& F) {
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

Mat3 cofactor(const Mat3& F) {
  Mat3 result;
  result << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
  return result;
}

// Column j of the cofactor is F_{j+1} × F_{j+2}; its derivative by F_{j+2} is [F_{j+1}]×.
Mat9 cofactor_derivative(const Mat3& F) {
  const auto cross_matrix = [](const Vec3& v) {
    Mat3 m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
  };
  Mat9 result = Mat9::Zero();
  for (int j = 0; j < 3; ++j) {
    const int next = (j + 1) % 3, last = (j + 2) % 3;
    result.block<3, 3>(3 * j, 3 * last) = cross_matrix(F.col(next));
    result.block<3, 3>(3 * j, 3 * next) = -cross_matrix(F.col(last));
  }
  return result;
}

}  // namespace palpate::elements
