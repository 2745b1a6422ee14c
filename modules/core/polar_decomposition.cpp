#include "modules/core/polar_decomposition.h"

#include <Eigen/LU>
#include <cmath>

namespace palpate {
namespace {

constexpr int kMaxNewton = 30;

/// Horn's matrix: tr(RᵀF) = qᵀ N q for the unit quaternion q = (w, x, y, z) of R.
Eigen::Matrix4d horn_matrix(const Mat3& F) {
  Eigen::Matrix4d N;
  const Vec3 turn(F(2, 1) - F(1, 2), F(0, 2) - F(2, 0), F(1, 0) - F(0, 1));
  N(0, 0) = F.trace();
  N.block<3, 1>(1, 0) = turn;
  N.block<1, 3>(0, 1) = turn.transpose();
  N.block<3, 3>(1, 1) = F + F.transpose() - F.trace() * Mat3::Identity();
  return N;
}

/// N without row and column k.
Mat3 without(const Eigen::Matrix4d& N, int k) {
  Mat3 minor;
  for (int r = 0, at = 0; r < 4; ++r) {
    if (r == k) continue;
    for (int c = 0, to = 0; c < 4; ++c) {
      if (c != k) minor(at, to++) = N(r, c);
    }
    ++at;
  }
  return minor;
}

/// Largest root of the characteristic polynomial λ⁴ − 2 tr(FᵀF) λ² − 8 det F λ + det N; no root is
/// above √(3 tr FᵀF), and from there Newton falls without overshooting.
double largest_eigenvalue(const Mat3& F, const Eigen::Matrix4d& N) {
  const double squared = F.squaredNorm();
  const double c2 = -2 * squared, c1 = -8 * F.determinant(), c0 = N.determinant();
  double root = std::sqrt(3 * squared);
  for (int k = 0; k < kMaxNewton; ++k) {
    const double value = ((root * root + c2) * root + c1) * root + c0;
    const double slope = (4 * root * root + 2 * c2) * root + c1;
    if (!(slope > 0)) break;
    const double change = value / slope;
    root -= change;
    if (std::abs(change) <= 1e-13 * root) break;
  }
  return root;
}

}  // namespace

Mat3 nearest_rotation(const Mat3& F) {
  Eigen::Matrix4d N = horn_matrix(F);
  const double root = largest_eigenvalue(F, N);
  N.diagonal().array() -= root;
  // Columns of the adjugate of a singular symmetric matrix are multiples of its null vector.
  int best = 0;
  double most = 0;
  for (int k = 0; k < 4; ++k) {
    const double cofactor = std::abs(without(N, k).determinant());
    if (cofactor > most) most = cofactor, best = k;
  }
  if (!(most > 1e-12 * root * root * root)) return Mat3::Identity();
  // q_best = 1, the others from the rows beside it.
  Vec3 right;
  for (int r = 0, at = 0; r < 4; ++r) {
    if (r != best) right[at++] = -N(r, best);
  }
  const Vec3 others = without(N, best).inverse() * right;
  Eigen::Vector4d q;
  for (int r = 0, at = 0; r < 4; ++r) q[r] = r == best ? 1 : others[at++];
  return Quat(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

}  // namespace palpate
