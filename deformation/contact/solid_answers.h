// How far a solid goes along with a touch: its answer to all rows together.
//
// As far_answers.h, among all nodes of a solid, with the matrix of its last step. A touch changes
// little from one period to the next, so conjugate gradients begin with what they found before.
#pragma once

#include <Eigen/Core>
#include <array>
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
  /// At most, for each direction: a touch that begins is answered within some per cent.
  static constexpr int kIterations = 8;

  /// @param body  outlives this
  explicit SolidAnswers(const Body& body);

  /// Begins anew.
  void forget();

  /// Finds X = A⁻¹ b of a push of 1 N along x, y and z spread evenly over the rows, and keeps its
  /// part beyond the small patch.
  /// @param last  of this body, a step was made
  /// @param near  the small patch
  /// @param shares  A, without damping; of K some
  void find(const StepMatrix& last, const SpringShares& shares, const Patch& near,
            std::span<const ComplianceRow> rows);

  /// A between the small patch and X  (3 near, 3)
  Eigen::MatrixXf near_block(const Patch& near) const;
  Eigen::Matrix3f own_block() const;  ///< Xᵀ A X
  /// Xᵀ of a push at a node; zero of nodes in the small patch.
  Eigen::Vector3f load(std::uint32_t node, const Vec3& push) const;
  /// How far a push of 1 N moves a node while all others are held; zero of fixed ones [m/N]
  Mat3 alone(std::uint32_t node) const { return inverse_blocks_[node].cast<double>(); }

  /// What it begins with.
  void exchange(StateArchive& archive) { archive(found_); }

 private:
  struct System;

  void take_matrix(const StepMatrix& last, const SpringShares& shares);
  void apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& q);
  double precondition();  ///< z = P r @returns r·z

  const Body& body_;
  // A = stiffness_ · (the step's) + diag(rest_)
  ElasticForceElements* elements_ = nullptr;
  float stiffness_ = 0;
  std::vector<float> rest_;
  std::vector<Eigen::Matrix3f> inverse_blocks_;           ///< P
  std::array<std::vector<Vec4f>, 3> found_;               ///< A⁻¹ b, to begin with
  std::array<std::vector<Vec4f>, 3> answers_, products_;  ///< X, and A X
  std::vector<Vec4f> load_, residual_, preconditioned_, direction_, product_;
};

}  // namespace palpate::deformation
