#include "deformation/materials/neo_hookean.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "modules/core/error.h"

namespace palpate::elements {
namespace {

Mat3 some_gradient() {
  Mat3 F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.3, 0.1, 1.1;
  return F;
}

TEST_CASE("neo-Hookean: stress and stiffness are derivatives of energy and stress") {
  // Oracle: central differences, error of order step² = 1e-10 relative.
  const Mat3 F = some_gradient();
  const double mu = 1700, step = 1e-5;
  const Mat9 stiffness = shape_stiffness(mu, F), second = cofactor_derivative(F);
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      Mat3 up = F, down = F;
      up(i, j) += step;
      down(i, j) -= step;
      const double slope = (shape_energy(mu, up) - shape_energy(mu, down)) / (2 * step);
      CHECK(shape_stress(mu, F)(i, j) == Approx(slope).epsilon(1e-7).margin(1e-5));
      const double volume_slope = (up.determinant() - down.determinant()) / (2 * step);
      CHECK(cofactor(F)(i, j) == Approx(volume_slope).epsilon(1e-8).margin(1e-9));
      const Mat3 change = (shape_stress(mu, up) - shape_stress(mu, down)) / (2 * step);
      CHECK((change.reshaped() - stiffness.col(i + 3 * j)).norm() < 1e-6 * stiffness.norm());
      const Mat3 turn = (cofactor(up) - cofactor(down)) / (2 * step);
      CHECK((turn.reshaped() - second.col(i + 3 * j)).norm() < 1e-9);
    }
  }
  CHECK((stiffness - stiffness.transpose()).norm() < 1e-12 * stiffness.norm());
}

TEST_CASE("neo-Hookean: turning the frame turns the stress, swelling costs nothing") {
  // Oracle: frame indifference ψ(RF) = ψ(F), P(RF) = R P(F); J^(−2/3) makes ψ(cF) = ψ(F).
  const Mat3 F = some_gradient(), R = Quat(0.5, 0.5, -0.5, 0.5).toRotationMatrix();
  CHECK(shape_energy(1, R * F) == Approx(shape_energy(1, F)));
  CHECK((shape_stress(1, R * F) - R * shape_stress(1, F)).norm() < 1e-14);
  CHECK(shape_energy(1, 1.3 * F) == Approx(shape_energy(1, F)));
  CHECK(shape_stress(1, 1.3 * R).norm() < 1e-14);
}

TEST_CASE("neo-Hookean: engineering constants, and what is refused") {
  // Oracle: the formulas; E = 9κμ/(3κ+μ).
  const auto tissue = NeoHookean::from_engineering(5000, 0.45);
  const double kappa = 1 / tissue.volume_compliance, mu = tissue.shear_modulus;
  CHECK(9 * kappa * mu / (3 * kappa + mu) == Approx(5000));
  CHECK(NeoHookean::from_engineering(5000, 0.5).volume_compliance == 0);
  CHECK_THROWS_WITH(NeoHookean::from_engineering(5000, 0.51),
                    Catch::Contains("0.51") && Catch::Contains("allowed: 0 to 0.5"));
  CHECK_THROWS_AS(NeoHookean::from_engineering(0, 0.3), InputError);
}

}  // namespace
}  // namespace palpate::elements
