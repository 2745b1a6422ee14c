#include "deformation/contact/solid_answers.h"

#include <Eigen/LU>

#include "deformation/linear_algebra/conjugate_gradients.h"

namespace palpate::deformation {
namespace {

/// Of b·P b. What the law of a shipped liver gives way by changes by less than 1 % with a tenth.
constexpr double kEnough = 1e-2;

}  // namespace

/// A x = b from the x there is, or from rest where that is nearer.
struct SolidAnswers::System {
  SolidAnswers& a;
  std::vector<Vec4f>& x;
  double whole;  ///< b·P b

  double begin() {
    a.apply(x, a.product_);
    add(-1, a.product_, a.residual_);
    double descent = a.precondition();
    if (!(descent < whole)) {
      std::ranges::fill(x, Vec4f::Zero());
      a.residual_ = a.load_;
      descent = a.precondition();
    }
    a.direction_ = a.preconditioned_;
    return descent;
  }
  double curvature() {
    a.apply(a.direction_, a.product_);
    return dot(a.direction_, a.product_);
  }
  double descend(double length) {
    add(length, a.direction_, x);
    add(-length, a.product_, a.residual_);
    return a.precondition();
  }
  void turn(double kept) {
    const auto part = static_cast<float>(kept);
    for (std::size_t i = 0; i < x.size(); ++i) {
      a.direction_[i] = a.preconditioned_[i] + part * a.direction_[i];
    }
  }
};

SolidAnswers::SolidAnswers(const Body& body) : body_(body) {
  const std::size_t count = body.node_count();
  rest_.assign(count, 0);
  inverse_blocks_.assign(count, Eigen::Matrix3f::Zero());
  for (auto* buffer : {&load_, &residual_, &preconditioned_, &direction_, &product_}) {
    buffer->assign(count, Vec4f::Zero());
  }
  answers_.fill(load_);
  products_.fill(load_);
  forget();
}

void SolidAnswers::forget() {
  for (auto& x : found_) x.assign(body_.node_count(), Vec4f::Zero());
}

void SolidAnswers::find(const StepMatrix& last, const SpringShares& shares, const Patch& near,
                        std::span<const ComplianceRow> rows) {
  take_matrix(last, shares);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::ranges::fill(load_, Vec4f::Zero());
    for (const ComplianceRow& row : rows) {
      for (const auto& [node, weight] : row.weights) {
        if (body_.inverse_masses[node] == 0) continue;
        load_[node][static_cast<int>(axis)] +=
            static_cast<float>(weight / static_cast<double>(rows.size()));
      }
    }
    residual_ = load_;
    const double whole = precondition();
    System system{*this, found_[axis], whole};
    conjugate_gradients(system, kIterations, kEnough * whole);
    answers_[axis] = found_[axis];
    for (const std::uint32_t node : near.nodes) answers_[axis][node].setZero();
    apply(answers_[axis], products_[axis]);
  }
}

void SolidAnswers::take_matrix(const StepMatrix& last, const SpringShares& shares) {
  const double stiffness = shares.stiffness / (last.step * last.step);
  elements_ = last.elements;
  stiffness_ = static_cast<float>(stiffness);
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    if (body_.inverse_masses[i] == 0) continue;
    const double rest = shares.mass * body_.masses[i] - stiffness * last.shift[i];
    rest_[i] = static_cast<float>(rest);
    const Mat3 block = stiffness * elements_->diagonal()[i] + rest * Mat3::Identity();
    inverse_blocks_[i] = block.inverse().cast<float>();
  }
}

/// Fixed nodes neither move nor answer.
void SolidAnswers::apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& q) {
  elements_->apply(p, q);
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = stiffness_ * q[i] + rest_[i] * p[i];
  for (const std::uint32_t node : body_.fixed_nodes) q[node].setZero();
}

double SolidAnswers::precondition() {
  for (std::size_t i = 0; i < residual_.size(); ++i) {
    preconditioned_[i].head<3>() = inverse_blocks_[i] * residual_[i].head<3>();
  }
  return dot(residual_, preconditioned_);
}

Eigen::MatrixXf SolidAnswers::near_block(const Patch& near) const {
  Eigen::MatrixXf block(static_cast<Eigen::Index>(3 * near.nodes.size()), 3);
  for (int axis = 0; axis < 3; ++axis) {
    const auto& product = products_[static_cast<std::size_t>(axis)];
    for (std::size_t i = 0; i < near.nodes.size(); ++i) {
      block.block<3, 1>(static_cast<Eigen::Index>(3 * i), axis) = product[near.nodes[i]].head<3>();
    }
  }
  return block;
}

Eigen::Matrix3f SolidAnswers::own_block() const {
  Eigen::Matrix3f block;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      block(static_cast<int>(a), static_cast<int>(b)) =
          static_cast<float>(dot(answers_[a], products_[b]));
    }
  }
  return block;
}

Eigen::Vector3f SolidAnswers::load(std::uint32_t node, const Vec3& push) const {
  const Vec4f pushed = wide(push);
  Eigen::Vector3f sum;
  for (int axis = 0; axis < 3; ++axis) {
    sum[axis] = answers_[static_cast<std::size_t>(axis)][node].dot(pushed);
  }
  return sum;
}

}  // namespace palpate::deformation
