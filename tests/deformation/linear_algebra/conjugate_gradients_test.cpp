#include "deformation/linear_algebra/conjugate_gradients.h"

#include <Eigen/Core>
#include <catch2/catch.hpp>

namespace palpate::deformation {
namespace {

/// A = diag(1 … n) with a coupling of neighbours, preconditioned by its diagonal.
struct Dense {
  Eigen::MatrixXd A;
  Eigen::VectorXd x, r, z, d, q;

  explicit Dense(int n) {
    A = Eigen::VectorXd::LinSpaced(n, 1, n).asDiagonal();
    for (int i = 0; i + 1 < n; ++i) A(i, i + 1) = A(i + 1, i) = 0.3;
    x.setZero(n);
    r.setOnes(n);
  }
  double precondition() {
    z = r.cwiseQuotient(A.diagonal());
    return r.dot(z);
  }
  double begin() {
    const double descent = precondition();
    d = z;
    return descent;
  }
  double curvature() {
    q = A * d;
    return d.dot(q);
  }
  double descend(double a) {
    x += a * d;
    r -= a * q;
    return precondition();
  }
  void turn(double b) { d = z + b * d; }
};

TEST_CASE("conjugate gradients: solves in as many iterations as there are unknowns") {
  // Oracle: finite termination in exact arithmetic; the residual b − A x computed anew.
  Dense system(12);
  const auto report = conjugate_gradients(system, 12, 1e-24);
  CHECK(report.converged);
  CHECK(report.iterations <= 12);
  CHECK((Eigen::VectorXd::Ones(12) - system.A * system.x).norm() < 1e-11);
}

TEST_CASE("conjugate gradients: stops at the number of iterations allowed") {
  // Oracle: the stated behaviour.
  Dense system(12);
  const auto report = conjugate_gradients(system, 3, 1e-24);
  CHECK_FALSE(report.converged);
  CHECK(report.iterations == 3);
}

TEST_CASE("conjugate gradients: a solved system and one that is not positive are left alone") {
  // Oracle: the stated behaviour.
  Dense solved(4), negative(4);
  solved.r.setZero();
  CHECK(conjugate_gradients(solved, 9, 0).converged);
  negative.A.block(0, 1, 1, 1).setZero();
  negative.A = -negative.A;
  negative.A.diagonal() *= -1;
  negative.A(0, 1) = negative.A(1, 0) = 50;
  negative.r << -1, 1, 0, 0;
  const auto report = conjugate_gradients(negative, 9, 1e-24);
  CHECK_FALSE(report.converged);
  CHECK(negative.x.norm() == 0);
}

}  // namespace
}  // namespace palpate::deformation
