// The springs about the contacts solved further than the rest.
//
// A truncated step of backward Euler (backward_euler.h) carries what changed at a contact as many
// springs further as it has iterations. On a fine mesh that is less far than the tissue moves
// within the step, and the force of a probe that turns about would come steps late. So the same
// equations are solved once more among the nodes about the closed contacts, all others held: one
// step of an alternating Schwarz method (H. A. Schwarz 1870; B. Smith, P. Bjørstad, W. Gropp,
// "Domain Decomposition", 1996), which never raises the step's energy. The pressure of the contents
// stays what the whole organ found.
#pragma once

#include <span>
#include <vector>

#include "deformation/contact/constraint_projection.h"
#include "deformation/linear_algebra/patch_matrix.h"
#include "deformation/model/organ_model.h"
#include "deformation/model/patch.h"
#include "deformation/springs/patch_springs.h"

namespace palpate::deformation {

class ContactRelaxation {
 public:
  /// At most. A touch of more is not local, and left to the whole organ's iterations.
  static constexpr std::size_t kNodes = 400;
  static constexpr int kIterations = 20;
  /// Where no more edges than these go along, a dozen iterations of the whole organ are enough.
  static constexpr double kEdges = 6;

  /// @param model  of springs, outlives this
  explicit ContactRelaxation(const OrganModel& model);

  /// Solves A Δ = r, B Δ = 0 among the nodes that go along with the rows'; B of those that press.
  /// @param positions  where A is taken [m]  (node_count)
  /// @param diagonal   3×3 blocks of A [kg]  (node_count)
  /// @param residual   r [N·s]  (node_count)
  /// @param rows       get what their impulses lack
  /// @returns false: there is no need, or the touch is not local; nothing was done
  bool solve(double h, const std::vector<Vec3>& positions, std::span<const Mat3> diagonal,
             const std::vector<Vec3>& residual, std::span<ContactRow> rows);

  const std::vector<std::uint32_t>& nodes() const { return patch_.nodes; }
  /// Δ of these nodes [m/s]
  const std::vector<Vec4f>& change() const { return change_; }

 private:
  bool grow(double h, const std::vector<Vec3>& positions, std::span<const Mat3> diagonal,
            std::span<const ContactRow> rows);
  void conjugate_gradients(double negligible);

  const OrganModel& model_;
  Neighbours neighbours_;
  PatchSprings springs_;
  Patch patch_;
  PatchMatrix matrix_;
  ConstraintProjection projection_;
  // Of the patch, and last a node that is held: it stands for all others.
  std::vector<Mat3> inverse_mass_blocks_;
  std::vector<Vec4f> residual_, change_, projected_, product_;
  std::vector<ContactRow> rows_;
};

}  // namespace palpate::deformation
