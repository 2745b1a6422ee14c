// The volume constraint on velocities, and positions put right after the step.
//
// U. M. Ascher, H. Chin, S. Reich, "Stabilization of DAEs and invariant manifolds", Numerische
// Mathematik 67, 1994; M. B. Cline, D. K. Pai, "Post-stabilization for rigid body simulation with
// contact and constraints", ICRA 2003:
//
//   g·v⁺ = 0:   (gᵀM⁻¹g) σ = g·v̂,   v⁺ = v̂ − M⁻¹g σ,   x̂ = x + h v⁺
//   x⁺ = x̂ − M⁻¹g (gᵀM⁻¹g)⁻¹ Φ(x̂),   g at x̂
//
// The second line is one Newton step onto the manifold V = V*. It moves positions only; velocities
// are not told. A step without it drifts by Φ = O(h²); it leaves O(Φ²) = O(h⁴). Contacts are solved
// with the velocity constraint; the projection moves contact nodes by its O(h²) and the next step's
// contacts undo that. A moving V* is followed by the projection alone.
#pragma once

#include "deformation/model/organ_model.h"
#include "deformation/volume/volume_rule.h"

namespace palpate::deformation {

class PostStabilisation : public VolumeRule {
 public:
  explicit PostStabilisation(const OrganModel& model);
  double largest_step() const override { return largest_step_; }
  bool reads_gradient() const override { return true; }
  VolumeAction before_contacts(double h, const OrganState& state, FreeStep& step) override;
  bool reads_end_gradient() const override { return true; }
  bool after_step(double h, const VolumeGradient& end, OrganState& state) override;

 private:
  const OrganModel& model_;
  double largest_step_;
};

}  // namespace palpate::deformation
