// What every constitutive law must keep (deformation/materials/constitutive_law.h). A new law is
// one more line of `Laws`.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <tuple>

#include "deformation/materials/corotated_linear.h"
#include "deformation/materials/isochoric_neo_hookean.h"
#include "deformation/materials/stable_neo_hookean.h"

namespace palpate::deformation {
namespace {

using Laws = std::tuple<CorotatedLinear,      //
                        IsochoricNeoHookean,  //
                        StableNeoHookean>;

const ElasticConstants kTissue(5000, 0.4);

Mat3 matrix(std::initializer_list<double> rows) {
  Mat3 F;
  auto at = rows.begin();
  for (int i = 0; i < 9; ++i) F(i / 3, i % 3) = *at++;
  return F;
}

/// Small, large, sheared, nearly flat.
const std::vector<Mat3> kGradients{
    matrix({1.01, 0.02, -0.01, 0, 0.99, 0.01, 0.02, -0.01, 1}),
    matrix({1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.3, 0.1, 1.1}),
    matrix({1, 0.7, 0, 0, 1, 0.4, 0, 0, 1}),
    matrix({1.5, 0.2, 0.1, -0.1, 0.3, 0.2, 0.3, 0.1, 1.4}),
};

/// About no axis of the grid.
const Mat3 kTurn = Quat(Eigen::AngleAxisd(1.3, Vec3(1, -2, 0.5).normalized())).toRotationMatrix();

}  // namespace

TEMPLATE_LIST_TEST_CASE("constitutive laws: stress is the energy's derivative", "", Laws) {
  // Oracle: central differences; error of order step² = 1e-10 relative, rounding 1e-16 / step.
  const TestType law(kTissue);
  const double step = 1e-5;
  for (const Mat3& F : kGradients) {
    const Mat3 stress = law.first_piola_stress(F);
    for (int k = 0; k < 9; ++k) {
      Mat3 up = F, down = F;
      up(k % 3, k / 3) += step;
      down(k % 3, k / 3) -= step;
      const double slope = (law.energy_density(up) - law.energy_density(down)) / (2 * step);
      CHECK(std::abs(stress(k % 3, k / 3) - slope) < 1e-7 * kTissue.youngs_modulus());
    }
  }
}

TEMPLATE_LIST_TEST_CASE("constitutive laws: ∂P/∂F is the stress's derivative, and symmetric", "",
                        Laws) {
  // Oracle: central differences, as above; a second derivative of ψ has a symmetric matrix.
  const TestType law(kTissue);
  const double step = 1e-5;
  for (const Mat3& F : kGradients) {
    const Mat9 derivative = law.stress_derivative(F);
    for (int k = 0; k < 9; ++k) {
      Mat3 up = F, down = F;
      up(k % 3, k / 3) += step;
      down(k % 3, k / 3) -= step;
      const Mat3 change = (law.first_piola_stress(up) - law.first_piola_stress(down)) / (2 * step);
      CHECK((change.reshaped() - derivative.col(k)).norm() < 1e-7 * derivative.norm());
    }
    CHECK((derivative - derivative.transpose()).norm() < 1e-12 * derivative.norm());
  }
}

TEMPLATE_LIST_TEST_CASE("constitutive laws: turning tissue turns its stress and costs nothing", "",
                        Laws) {
  // Oracle: objectivity ψ(RF) = ψ(F), P(RF) = R P(F); rounding.
  const TestType law(kTissue);
  for (const Mat3& F : kGradients) {
    const Mat3 stress = law.first_piola_stress(F);
    CHECK(law.energy_density(kTurn * F) == Approx(law.energy_density(F)).epsilon(1e-10));
    CHECK((law.first_piola_stress(kTurn * F) - kTurn * stress).norm() < 1e-10 * stress.norm());
  }
}

TEMPLATE_LIST_TEST_CASE("constitutive laws: all directions of the tissue are alike", "", Laws) {
  // Oracle: isotropy ψ(FR) = ψ(F), P(FR) = P(F) R; rounding.
  const TestType law(kTissue);
  for (const Mat3& F : kGradients) {
    const Mat3 stress = law.first_piola_stress(F);
    CHECK(law.energy_density(F * kTurn) == Approx(law.energy_density(F)).epsilon(1e-10));
    CHECK((law.first_piola_stress(F * kTurn) - stress * kTurn).norm() < 1e-10 * stress.norm());
  }
}

TEMPLATE_LIST_TEST_CASE("constitutive laws: at rest there is neither energy nor stress", "", Laws) {
  // Oracle: the reference state. Rotations are off by some 1e-16, which moduli of 1e4 Pa and a
  // dozen operations make 1e-11 Pa.
  const TestType law(kTissue);
  for (const Mat3& R : {Mat3(Mat3::Identity()), kTurn}) {
    CHECK(std::abs(law.energy_density(R)) < 1e-10);
    CHECK(law.first_piola_stress(R).norm() < 1e-10);
  }
}

TEMPLATE_LIST_TEST_CASE("constitutive laws: small shear meets the shear modulus", "", Laws) {
  // Oracle: linear elasticity, ∂P₁₂/∂F₁₂ + ∂P₁₂/∂F₂₁ = 2 μ at rest for a symmetric shear.
  const TestType law(kTissue);
  const Mat9 derivative = law.stress_derivative(Mat3::Identity());
  const int xy = 0 + 3 * 1, yx = 1 + 3 * 0;
  CHECK(derivative(xy, xy) + derivative(xy, yx) == Approx(2 * kTissue.shear_modulus()));
}

}  // namespace palpate::deformation
