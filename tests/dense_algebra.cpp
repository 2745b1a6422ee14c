#include "tests/dense_algebra.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace palpate::testing {

Eigen::MatrixXd solved(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b) {
  return A.fullPivLu().solve(b);
}

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& A) { return A.fullPivLu().inverse(); }

Eigen::VectorXd eigenvalues_of(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::VectorXd eigenvalues_of(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(A, B, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

}  // namespace palpate::testing
