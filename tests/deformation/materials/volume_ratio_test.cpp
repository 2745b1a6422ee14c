#include "deformation/materials/volume_ratio.h"

#include <Eigen/LU>
#include <catch2/catch.hpp>

namespace palpate::deformation {

TEST_CASE("volume ratio: cofactor and its derivative are the derivatives of the determinant") {
  // Oracle: central differences; J is cubic, so that errors are step² = 1e-10 and rounding.
  Mat3 F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.3, 0.1, 1.1;
  const double step = 1e-5;
  const Mat9 second = cofactor_derivative(F);
  for (int k = 0; k < 9; ++k) {
    Mat3 up = F, down = F;
    up(k % 3, k / 3) += step;
    down(k % 3, k / 3) -= step;
    const double slope = (up.determinant() - down.determinant()) / (2 * step);
    CHECK(cofactor(F)(k % 3, k / 3) == Approx(slope).epsilon(1e-8).margin(1e-9));
    const Mat3 change = (cofactor(up) - cofactor(down)) / (2 * step);
    CHECK((change.reshaped() - second.col(k)).norm() < 1e-9);
  }
}

}  // namespace palpate::deformation
