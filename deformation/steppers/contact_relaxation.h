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
#include "deformation/model/organ_model.h"
#include "deformation/model/patch.h"
#include "deformation/springs/patch_product.h"

namespace palpate::deformation {

class ContactRelaxation {
 public:
  /// At most.
  static constexpr int kIterations = 12;
  /// Where no more edges than these go along, a dozen iterations of the whole organ are enough.
  static constexpr double kEdges = 6;

  /// @param model    of springs, outlives this
  /// @param springs  A, linearised before rows are chosen; outlives this
  /// @param runner   outlives this; none: the calling thread alone. The bits are the same
  ContactRelaxation(const OrganModel& model, SpringHessianProduct& springs,
                    ChunkRunner* runner = nullptr);

  /// A touch of more nodes is not local: that of a plate.
  static constexpr std::size_t kMostTouched = 2000;

  /// Chooses the nodes that go along with the rows', at most kMostInReach or twice as many as
  /// those.
  /// @param positions  where A is taken [m]  (node_count)
  /// @returns false: there is no need, or the touch is not local
  bool choose(double h, const std::vector<Vec3>& positions, std::span<const ContactRow> rows);
  const std::vector<std::uint32_t>& nodes() const { return patch_.nodes; }
  const std::vector<std::uint32_t>& slices() const { return slices_; }

  /// Solves A Δ = r, B Δ = 0 among these nodes; B of the rows that press, couplings of A those of
  /// now.
  /// @param inverse_mass_blocks  W [1/kg]  (node_count)
  /// @param residual   r [N·s]  (node_count)
  /// @param rows       get what their impulses lack
  void solve(std::span<const Mat3> inverse_mass_blocks, const std::vector<Vec3>& residual,
             std::span<ContactRow> rows);
  /// Δ of these nodes [m/s]
  const std::vector<Vec4f>& change() const { return change_; }

 private:
  const OrganModel& model_;
  SpringHessianProduct& springs_;
  Neighbours neighbours_;
  Patch patch_;
  std::vector<std::uint32_t> slices_;
  PatchProduct product_;
  ConstraintProjection projection_;
  // Of the patch, and last the node that is held.
  std::vector<Mat3> inverse_mass_blocks_;
  std::vector<Vec4f> residual_, change_, projected_, products_;
  std::vector<ContactRow> rows_;
};

}  // namespace palpate::deformation
