#include "deformation/steppers/corotational.h"

#include <Eigen/LU>
#include <cmath>

namespace palpate::deformation {
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

Corotational::Corotational(const OrganModel& model)
    : model_(model),
      tetrahedra_(model),
      pairs_(model.node_count(), model.mesh().tetrahedra),
      matrix_(pairs_) {
  const double E = model.mesh().youngs_modulus, nu = model.mesh().poisson_ratio;
  mu_ = E / (2 * (1 + nu));
  lambda_ = E * nu / ((1 + nu) * (1 - 2 * nu));
  forces_.assign(model.node_count(), Vec3::Zero());
  diagonal_.assign(model.node_count(), Mat3::Zero());
}

void Corotational::linearise(const std::vector<Vec3>& positions, double h) {
  std::fill(forces_.begin(), forces_.end(), Vec3::Zero());
  matrix_.set_zero();
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    add_tetrahedron(e, positions, static_cast<float>(h * h));
  }
  for (std::size_t i = 0; i < model_.node_count(); ++i) {
    matrix_.add(pairs_.diagonals[i], static_cast<float>((1 + h * model_.drag) * model_.masses[i]));
  }
  matrix_.mirror();
  for (std::size_t i = 0; i < model_.node_count(); ++i) diagonal_[i] = matrix_.diagonal(i);
}

void Corotational::add_tetrahedron(std::size_t e, const std::vector<Vec3>& positions, float h2) {
  const auto& corners = tetrahedra_.corners[e];
  const Mat3 F = tetrahedra_.deformation_gradient(e, positions);
  const Mat3 R = nearest_rotation(F);
  const double volume = tetrahedra_.volumes[e];
  const double pull = lambda_ * (R.cwiseProduct(F).sum() - 3) - 2 * mu_;
  const Mat34 pushes = -volume * ((2 * mu_ * F + pull * R) * tetrahedra_.gradients[e]);
  const Mat34 turned = R * tetrahedra_.gradients[e];
  std::array<Vec4f, 4> g;
  for (int a = 0; a < 4; ++a) {
    forces_[corners[static_cast<std::size_t>(a)]] += pushes.col(a);
    g[static_cast<std::size_t>(a)] = wide(turned.col(a));
  }
  const float mu = h2 * static_cast<float>(volume * mu_);
  const float lambda = h2 * static_cast<float>(volume * lambda_);
  for (std::size_t a = 0; a < 4; ++a) {
    const Vec4f along = lambda * g[a], across = mu * g[a];
    for (std::size_t b = 0; b < 4; ++b) {
      if (corners[b] < corners[a]) continue;
      Block4f block;
      const float both = across.dot(g[b]);
      for (int k = 0; k < 3; ++k) {
        auto& column = block[static_cast<std::size_t>(k)];
        column = g[b][k] * along + across[k] * g[b];
        column[k] += both;
      }
      matrix_.add(pairs_.of_tetrahedra[e][4 * a + b], block);
    }
  }
}

double Corotational::energy(const std::vector<Vec3>& positions) {
  double sum = 0;
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    const Mat3 F = tetrahedra_.deformation_gradient(e, positions);
    const Mat3 R = nearest_rotation(F);
    const double stretch = R.cwiseProduct(F).sum() - 3;
    sum += tetrahedra_.volumes[e] * (mu_ * (F - R).squaredNorm() + lambda_ / 2 * stretch * stretch);
  }
  return sum;
}

}  // namespace palpate::deformation
