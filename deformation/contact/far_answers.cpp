#include "deformation/contact/far_answers.h"

#include <Eigen/LU>

#include "deformation/linear_algebra/conjugate_gradients.h"

namespace palpate::deformation {
namespace {

/// Of r·W r: directions need not be more exact.
constexpr double kEnough = 1e-3;

}  // namespace

FarAnswers::FarAnswers(const OrganModel& model, ChunkRunner* runner)
    : model_(model), springs_(model, model.network(), false, runner), product_(springs_, runner) {}

void FarAnswers::find(const std::vector<Vec3>& positions, const Neighbours& neighbours,
                      std::span<const std::uint32_t> touched, const Vec3& centre, std::size_t near,
                      std::size_t nodes, std::span<const ComplianceRow> rows,
                      const SpringShares& shares) {
  grow_patch(model_, neighbours, positions, touched, centre, nodes, patch_);
  const std::size_t count = patch_.nodes.size();
  near_ = std::min(near, count);
  springs_.find_slices(patch_.nodes, slices_);
  springs_.linearise(positions, shares, slices_);
  product_.take(patch_);
  inverse_blocks_.clear();
  for (const std::uint32_t node : patch_.nodes) {
    inverse_blocks_.push_back(springs_.diagonal()[node].inverse());
  }
  for (auto* buffer : {&preconditioned_, &step_}) buffer->assign(count, Vec4f::Zero());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    answers_[axis].assign(count, Vec4f::Zero());
    residual_.assign(count, Vec4f::Zero());
    for (const ComplianceRow& row : rows) {
      for (const auto& [node, weight] : row.weights) {
        const int place = patch_.place(node);
        if (place >= 0) {
          residual_[static_cast<std::size_t>(place)][static_cast<int>(axis)] +=
              static_cast<float>(weight);
        }
      }
    }
    preconditioner_.prepare(inverse_blocks_, {}, {});
    ProjectedSystem<PatchProduct> system{preconditioner_, product_,        answers_[axis],
                                         residual_,       preconditioned_, step_};
    conjugate_gradients(system, kIterations, 0, kEnough);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < count; ++i) {
      if (i < near_) answers_[axis][i].setZero();
      product_.nodes()[i].vector = answers_[axis][i];
    }
    products_[axis].resize(count);
    product_.apply(products_[axis]);
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
