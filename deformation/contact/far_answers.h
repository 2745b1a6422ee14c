// How far the tissue around a touch goes along: its answer to all rows together.
//
// Beyond the nodes of a small patch what a contact does looks like one push. So three directions
// stand for a patch many times as large: its answers X = A⁻¹ b to a push along x, y and z spread
// evenly over the rows, by conjugate gradients. With them beside its own nodes' the small patch
// gives way as in the large one (Galerkin): never more than it, and exactly as much where a push is
// spread so.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "deformation/contact/compliance_row.h"
#include "deformation/linear_algebra/patch_matrix.h"
#include "deformation/model/body.h"
#include "deformation/model/patch.h"
#include "deformation/springs/patch_springs.h"

namespace palpate::deformation {

class FarAnswers {
 public:
  /// As many as springs between the middle and the rim of that.
  static constexpr int kIterations = 10;

  /// @param body, springs  outlive this
  FarAnswers(const Body& body, const PatchSprings& springs) : body_(body), springs_(springs) {}

  /// Finds X, and keeps its part beyond the first `near` nodes, the small patch.
  /// @param touched, centre  as the small patch was grown (patch.h)
  /// @param nodes  of the large patch, at most
  /// @param shares  A
  void find(const std::vector<Vec3>& positions, const Neighbours& neighbours,
            std::span<const std::uint32_t> touched, const Vec3& centre, std::size_t near,
            std::size_t nodes, std::span<const ComplianceRow> rows, const SpringShares& shares);

  Eigen::MatrixXf near_block() const;  ///< A between the small patch and X  (3 near, 3)
  Eigen::Matrix3f own_block() const;   ///< Xᵀ A X
  /// Xᵀ of a push at a node; zero of nodes in the small patch and beyond the large one.
  Eigen::Vector3f load(std::uint32_t node, const Vec3& push) const;

 private:
  const Body& body_;
  const PatchSprings& springs_;
  std::size_t near_ = 0;
  Patch patch_;
  PatchMatrix matrix_;
  std::vector<Eigen::Matrix3f> preconditioner_;
  std::array<std::vector<Vec4f>, 3> answers_, products_;  ///< X, and A X  (of the patch)
  std::vector<Vec4f> residual_, preconditioned_, product_;
};

}  // namespace palpate::deformation
