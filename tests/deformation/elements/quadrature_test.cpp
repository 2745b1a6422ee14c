#include "deformation/elements/quadrature.h"

#include <catch2/catch.hpp>
#include <cmath>

namespace palpate::deformation {
namespace {

template <typename Rule>
double integral(const Rule& rule, int i, int j, int k) {
  double sum = 0;
  for (const auto& [l, weight] : rule) {
    sum += weight * std::pow(l[0], i) * std::pow(l[1], j) * std::pow(l[2], k);
  }
  return sum;
}

double factorial(int n) { return std::tgamma(n + 1); }

TEST_CASE("quadrature: tetrahedron rules integrate every monomial up to their degree") {
  // Oracle: mean of L₀ⁱ L₁ʲ L₂ᵏ over a tetrahedron = 3! i! j! k! / (i+j+k+3)!. Rounding only.
  for (int i = 0; i <= 5; ++i) {
    for (int j = 0; i + j <= 5; ++j) {
      for (int k = 0; i + j + k <= 5; ++k) {
        const double exact =
            6 * factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3);
        CHECK(integral(fourteen_point_rule(), i, j, k) == Approx(exact).epsilon(1e-13));
        if (i + j + k > 2) continue;
        CHECK(integral(four_point_rule(), i, j, k) == Approx(exact).epsilon(1e-13));
      }
    }
  }
}

TEST_CASE("quadrature: the triangle rule integrates every monomial up to degree 4") {
  // Oracle: mean of L₀ⁱ L₁ʲ over a triangle = 2! i! j! / (i+j+2)!; the points have 15 digits.
  for (int i = 0; i <= 4; ++i) {
    for (int j = 0; i + j <= 4; ++j) {
      const double exact = 2 * factorial(i) * factorial(j) / factorial(i + j + 2);
      CHECK(integral(six_point_rule(), i, j, 0) == Approx(exact).epsilon(1e-13));
    }
  }
}

TEST_CASE("quadrature: shapes are 1 at their node, sum to 1, and have the printed gradients") {
  // Oracle: definition; central differences, exact for quadratics up to rounding.
  const Eigen::Vector4d l(0.1, 0.2, 0.3, 0.4);
  CHECK(quadratic_shape(l).sum() == Approx(1));
  CHECK(quadratic_shape(Eigen::Vector4d::Unit(2))[2] == 1);
  for (int e = 0; e < 6; ++e) {
    Eigen::Vector4d middle = Eigen::Vector4d::Zero();
    for (const int corner : kTetrahedronEdges[e]) middle[corner] = 0.5;
    CHECK(quadratic_shape(middle).isApprox(Eigen::Matrix<double, kElementNodes, 1>::Unit(4 + e)));
  }
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector4d step = Eigen::Vector4d::Zero();
    step[0] = -0.01;
    step[i + 1] = 0.01;
    const Eigen::Matrix<double, kElementNodes, 1> slope =
        (quadratic_shape(l + step) - quadratic_shape(l - step)) / 0.02;
    CHECK((slope - quadratic_shape_gradient(l).col(i)).norm() < 1e-13);
  }
  const Vec3 m(0.2, 0.3, 0.5);
  CHECK(face_shape(m).sum() == Approx(1));
  for (int i = 0; i < 2; ++i) {
    Vec3 step(-0.01, 0, 0);
    step[i + 1] = 0.01;
    const Eigen::Matrix<double, kFaceNodes, 1> slope =
        (face_shape(m + step) - face_shape(m - step)) / 0.02;
    CHECK((slope - face_shape_gradient(m).col(i)).norm() < 1e-13);
  }
}

}  // namespace
}  // namespace palpate::deformation
