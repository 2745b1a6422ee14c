#include "deformation/materials/corotated_linear.h"

#include <Eigen/LU>

#include "modules/core/polar_decomposition.h"

namespace palpate::deformation {

double CorotatedLinear::energy_density(const Mat3& F) const {
  const Mat3 R = nearest_rotation(F);
  const double stretch = R.cwiseProduct(F).sum() - 3;
  return shear_modulus * (F - R).squaredNorm() + lambda / 2 * stretch * stretch;
}

Mat3 CorotatedLinear::first_piola_stress(const Mat3& F) const {
  return first_piola_stress(F, nearest_rotation(F));
}

// As F changes by δF, R changes by R [ω]× with
//   (tr S 1 − S) ω = axial vector of RᵀδF − δFᵀR,   S = RᵀF.
Mat9 CorotatedLinear::stress_derivative(const Mat3& F) const {
  const Mat3 R = nearest_rotation(F), S = R.transpose() * F;
  const Mat3 turning = (S.trace() * Mat3::Identity() - S).inverse();
  const double along_R = lambda * (S.trace() - 3) - 2 * shear_modulus;
  Mat9 derivative;
  for (int k = 0; k < 9; ++k) {
    Mat3 dF = Mat3::Zero();
    dF(k % 3, k / 3) = 1;
    const Mat3 A = R.transpose() * dF;
    const Vec3 w = turning * Vec3(A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1));
    Mat3 cross;
    cross << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    const Mat3 dP = 2 * shear_modulus * dF + along_R * R * cross + lambda * A.trace() * R;
    derivative.col(k) = dP.reshaped();
  }
  return derivative;
}

}  // namespace palpate::deformation
