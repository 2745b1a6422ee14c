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
#include "deformation/contact/constraint_projection.h"
#include "deformation/model/organ_model.h"
#include "deformation/model/patch.h"
#include "deformation/springs/patch_product.h"

namespace palpate::deformation {

class FarAnswers {
 public:
  /// At most. Further ones would find less than a touch grows by within the period.
  static constexpr int kIterations = 8;

  /// @param model   of springs, outlives this
  /// @param runner  outlives this; none: the calling thread alone. The bits are the same
  explicit FarAnswers(const OrganModel& model, ChunkRunner* runner = nullptr);

  /// Finds X, and keeps its part beyond the first `near` nodes, the small patch.
  /// @param touched, centre  as the small patch was grown (patch.h)
  /// @param nodes  of the large patch, at most
  /// @param shares  A
  void find(const std::vector<Vec3>& positions, const Neighbours& neighbours,
            std::span<const std::uint32_t> touched, const Vec3& centre, std::size_t near,
            std::size_t nodes, std::span<const ComplianceRow> rows, const SpringShares& shares);

  Eigen::MatrixXf near_block() const;  ///< A between the small patch and X  (3 near, 3)
  Eigen::Matrix3f own_block() const;   ///< Xᵀ A X
  /// How far a push of 1 N moves a node of the large patch while all others are held; none: it is
  /// not among them [m/N]
  const Mat3* alone(std::uint32_t node) const {
    const int place = patch_.place(node);
    return place < 0 ? nullptr : &inverse_blocks_[static_cast<std::size_t>(place)];
  }
  /// Xᵀ of a push at a node; zero of nodes in the small patch and beyond the large one.
  Eigen::Vector3f load(std::uint32_t node, const Vec3& push) const;

 private:
  const OrganModel& model_;
  SpringHessianProduct springs_;
  PatchProduct product_;
  ConstraintProjection preconditioner_;  ///< without rows: 3×3 diagonal blocks
  std::size_t near_ = 0;
  Patch patch_;
  std::vector<std::uint32_t> slices_;
  std::vector<Mat3> inverse_blocks_;
  std::array<std::vector<Vec4f>, 3> answers_, products_;  ///< X, and A X  (of the patch)
  std::vector<Vec4f> residual_, preconditioned_, step_;
};

}  // namespace palpate::deformation
