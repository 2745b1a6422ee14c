// How far a solid goes along with a touch: its answer to all rows together.
//
// As far_answers.h, among all nodes of a solid, with the matrix of its last step. A touch changes
// little from one period to the next, so conjugate gradients begin with what they found before.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "deformation/contact/compliance_row.h"
#include "deformation/elements/step_matrix.h"
#include "deformation/model/body.h"
#include "deformation/model/patch.h"
#include "deformation/springs/spring_hessian_product.h"
#include "modules/core/state_archive.h"

namespace palpate::deformation {

class SolidAnswers {
 public:
  /// At most, for each direction: a touch that begins is answered to within some per cent.
  static constexpr int kIterations = 8;

  /// @param body  outlives this
  explicit SolidAnswers(const Body& body);

  /// Begins anew.
  void forget();
  /// How far nodes go, of one mesh on another.
  using Carry = std::function<std::vector<Vec4f>(const std::vector<Vec4f>&)>;
  /// Begins with what was found on a mesh before. @param carried  to this body's
  void begin_with(const SolidAnswers& before, const Carry& carried);

  /// Finds X = A⁻¹ b of a push of 1 N along x, y and z spread evenly over the rows, and keeps its
  /// part beyond the small patch.
  /// @param last  of this body, a step was made
  /// @param near  the small patch
  /// @param shares  A, without damping; of K some
  /// @param pressed  A of the small patch, lower triangle  (3 near, 3 near)
  void find(const StepMatrix& last, const SpringShares& shares, const Patch& near,
            const Eigen::MatrixXf& pressed, std::span<const ComplianceRow> rows);

  const Eigen::MatrixXf& near_block() const { return near_block_; }  ///< A X  (3 near, 3)
  const Eigen::Matrix3f& own_block() const { return own_block_; }    ///< Xᵀ A X
  /// Xᵀ of a push at a node; zero of nodes in the small patch.
  Eigen::Vector3f load(std::uint32_t node, const Vec3& push) const;
  /// How far a push of 1 N moves a node while all others are held; zero of fixed ones [m/N]
  Mat3 alone(std::uint32_t node) const;

  /// What it begins with.
  void exchange(StateArchive& archive) { archive(found_); }

 private:
  struct System;

  void take_matrix(const StepMatrix& last, const SpringShares& shares);
  double apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& q);  ///< q = A p @returns p·q
  double go(double length, std::vector<Vec4f>& x);                   ///< @returns r·z
  void couple(const Patch& near, const Eigen::MatrixXf& pressed);

  const Body& body_;
  // A = stiffness_ · (the step's) + diag(rest_)
  ElasticForceElements* elements_ = nullptr;
  float stiffness_ = 0;
  std::vector<float> rest_;
  std::vector<std::array<Vec4f, 3>> inverse_blocks_;    ///< P, by columns
  std::array<std::vector<Vec4f>, 3> found_, products_;  ///< A⁻¹ b, to begin with; A of that
  std::array<std::vector<Vec4f>, 3> answers_;           ///< X
  Eigen::MatrixXf near_block_;
  Eigen::Matrix3f own_block_;
  std::vector<Vec4f> load_, residual_, preconditioned_, direction_, product_;
};

}  // namespace palpate::deformation
