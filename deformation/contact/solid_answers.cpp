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
    std::ranges::fill(a.direction_, Vec4f::Zero());
    a.apply(x, a.product_);
    add(-1, a.product_, a.residual_);
    double descent = a.go(0, x);
    if (!(descent < whole)) {
      std::ranges::fill(x, Vec4f::Zero());
      a.residual_ = a.load_;
      descent = a.go(0, x);
    }
    a.direction_ = a.preconditioned_;
    return descent;
  }
  double curvature() { return a.apply(a.direction_, a.product_); }
  double descend(double length) { return a.go(length, x); }
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
  inverse_blocks_.assign(count, {Vec4f::Zero(), Vec4f::Zero(), Vec4f::Zero()});
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

void SolidAnswers::begin_with(const SolidAnswers& before, const Carry& carried) {
  for (std::size_t axis = 0; axis < found_.size(); ++axis) {
    found_[axis] = carried(before.found_[axis]);
  }
}

void SolidAnswers::find(const StepMatrix& last, const SpringShares& shares, const Patch& near,
                        const Eigen::MatrixXf& pressed, std::span<const ComplianceRow> rows) {
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
    std::ranges::fill(direction_, Vec4f::Zero());
    std::ranges::fill(product_, Vec4f::Zero());
    const double whole = go(0, found_[axis]);
    System system{*this, found_[axis], whole};
    conjugate_gradients(system, kIterations, kEnough * whole);
    products_[axis] = load_;
    add(-1, residual_, products_[axis]);
  }
  couple(near, pressed);
}

/// What A does to all that was found is known; the small patch's part is taken off.
void SolidAnswers::couple(const Patch& near, const Eigen::MatrixXf& pressed) {
  const auto count = static_cast<Eigen::Index>(3 * near.nodes.size());
  Eigen::MatrixXf there(count, 3);
  near_block_.resize(count, 3);
  answers_ = found_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto column = static_cast<Eigen::Index>(axis);
    for (std::size_t i = 0; i < near.nodes.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(3 * i);
      Vec4f& answer = answers_[axis][near.nodes[i]];
      there.block<3, 1>(at, column) = answer.head<3>();
      near_block_.block<3, 1>(at, column) = products_[axis][near.nodes[i]].head<3>();
      answer.setZero();
    }
  }
  // Eigen takes the address of a matrix' first number, of which a patch of held nodes has none.
  if (count > 0) near_block_ -= pressed.selfadjointView<Eigen::Lower>() * there;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      own_block_(a, b) = static_cast<float>(
          dot(answers_[static_cast<std::size_t>(a)], products_[static_cast<std::size_t>(b)]));
    }
  }
  own_block_ -= near_block_.transpose() * there;
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
    const Mat3 inverse = block.inverse();
    for (int k = 0; k < 3; ++k) {
      inverse_blocks_[i][static_cast<std::size_t>(k)] = wide(inverse.col(k));
    }
  }
}

/// Fixed nodes neither move nor answer. Summed as dot() does, in the same pass.
double SolidAnswers::apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& q) {
  elements_->apply(p, q);
  for (const std::uint32_t node : body_.fixed_nodes) q[node].setZero();
  double sum = 0;
  for (std::size_t first = 0; first < q.size(); first += kDotBlock) {
    Vec4f block = Vec4f::Zero();
    for (std::size_t i = first; i < std::min(first + kDotBlock, q.size()); ++i) {
      q[i] = stiffness_ * q[i] + rest_[i] * p[i];
      block += q[i].cwiseProduct(p[i]);
    }
    sum += block.sum();
  }
  return sum;
}

double SolidAnswers::go(double length, std::vector<Vec4f>& x) {
  return go_along(length, direction_, product_, inverse_blocks_, x, residual_, preconditioned_)
      .descent;
}

Mat3 SolidAnswers::alone(std::uint32_t node) const {
  Mat3 inverse;
  for (int k = 0; k < 3; ++k) {
    inverse.col(k) = inverse_blocks_[node][static_cast<std::size_t>(k)].head<3>().cast<double>();
  }
  return inverse;
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
