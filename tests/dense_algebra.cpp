#include "tests/dense_algebra.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace palpate {

Eigen::MatrixXd solved(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b) {
  return A.partialPivLu().solve(b);
}

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& A) { return A.partialPivLu().inverse(); }

Eigen::VectorXd eigenvalues_of(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::VectorXd eigenvalues_of(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(A, B, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

Eigen::VectorXcd roots_of(const Eigen::MatrixXd& A) { return A.eigenvalues(); }

}  // namespace palpate
