// Dense linear algebra in double, for tests whose oracle it is. Compiled once: each of Eigen's
// decompositions costs a file seconds.
#pragma once

#include <Eigen/Core>

namespace palpate {

/// A⁻¹ b, by LU with partial pivoting. @param A  regular
Eigen::MatrixXd solved(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b);

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& A);

/// Of a symmetric matrix, ascending.
Eigen::VectorXd eigenvalues_of(const Eigen::MatrixXd& A);
/// λ of A x = λ B x, B positive definite.
Eigen::VectorXd eigenvalues_of(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// Of any square matrix.
Eigen::VectorXcd roots_of(const Eigen::MatrixXd& A);

}  // namespace palpate
