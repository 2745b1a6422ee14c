#include "deformation/contact/far_answers.h"

#include <Eigen/LU>

#include "deformation/linear_algebra/conjugate_gradients.h"

namespace palpate::deformation {
namespace {

/// Of r·W r: directions need not be more exact.
constexpr double kEnough = 1e-3;

Vec4f times(const Eigen::Matrix3f& matrix, const Vec4f& v) {
  Vec4f out = Vec4f::Zero();
  out.head<3>() = matrix * v.head<3>();
  return out;
}

/// A x = r with the patch's nodes as vectors of A.
struct System {
  PatchMatrix& A;
  const std::vector<Eigen::Matrix3f>& preconditioner;
  std::vector<Vec4f>&x, &r, &z, &q;

  double begin() {
    precondition();
    for (std::size_t i = 0; i < z.size(); ++i) A.nodes()[i].vector = z[i];
    return dot(r, z);
  }
  double curvature() { return A.apply(q); }
  double descend(double a) {
    const auto step = static_cast<float>(a);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += step * A.nodes()[i].vector;
    add(-a, q, r);
    precondition();
    return dot(r, z);
  }
  void turn(double b) {
    const auto kept = static_cast<float>(b);
    for (std::size_t i = 0; i < z.size(); ++i) {
      A.nodes()[i].vector = z[i] + kept * A.nodes()[i].vector;
    }
  }
  void precondition() {
    for (std::size_t i = 0; i < z.size(); ++i) z[i] = times(preconditioner[i], r[i]);
  }
};

}  // namespace

void FarAnswers::find(const std::vector<Vec3>& positions, const Neighbours& neighbours,
                      std::span<const std::uint32_t> touched, const Vec3& centre, std::size_t near,
                      std::size_t nodes, std::span<const ComplianceRow> rows,
                      const SpringShares& shares) {
  grow_patch(body_, neighbours, positions, touched, centre, nodes, patch_);
  near_ = std::min(near, patch_.nodes.size());
  springs_.assemble(positions, body_.masses, patch_, shares, matrix_);
  const std::size_t count = patch_.nodes.size();
  preconditioner_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    preconditioner_[i] = matrix_.diagonal(i).inverse();
  }
  for (auto* buffer : {&residual_, &preconditioned_, &product_}) {
    buffer->assign(count, Vec4f::Zero());
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    answers_[axis].assign(count, Vec4f::Zero());
    residual_.assign(count, Vec4f::Zero());
    for (const ComplianceRow& row : rows) {
      for (const auto& [node, weight] : row.weights) {
        const int place = patch_.place(node);
        if (place >= 0) residual_[static_cast<std::size_t>(place)][axis] += weight;
      }
    }
    System system{matrix_, preconditioner_, answers_[axis], residual_, preconditioned_, product_};
    conjugate_gradients(system, kIterations, kEnough * system.begin());
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < count; ++i) {
      if (i < near_) answers_[axis][i].setZero();
      matrix_.nodes()[i].vector = answers_[axis][i];
    }
    products_[axis].resize(count);
    matrix_.apply(products_[axis]);
  }
}

Eigen::MatrixXf FarAnswers::near_block() const {
  Eigen::MatrixXf block(static_cast<Eigen::Index>(3 * near_), 3);
  for (int axis = 0; axis < 3; ++axis) {
    const auto& product = products_[static_cast<std::size_t>(axis)];
    for (std::size_t i = 0; i < near_; ++i) {
      block.block<3, 1>(static_cast<Eigen::Index>(3 * i), axis) = product[i].head<3>();
    }
  }
  return block;
}

Eigen::Matrix3f FarAnswers::own_block() const {
  Eigen::Matrix3f block;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      block(a, b) = static_cast<float>(dot(answers_[a], products_[b]));
    }
  }
  return block;
}

Eigen::Vector3f FarAnswers::load(std::uint32_t node, const Vec3& push) const {
  const int place = patch_.place(node);
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  if (place < 0) return sum;
  const Vec4f pushed = wide(push);
  for (int axis = 0; axis < 3; ++axis) {
    sum[axis] =
        answers_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(place)].dot(pushed);
  }
  return sum;
}

}  // namespace palpate::deformation
