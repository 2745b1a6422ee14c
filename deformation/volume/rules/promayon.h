// The volume restored after the step by a projection along its gradient.
//
// E. Promayon, P. Baconnier, C. Puech, "Physically-based deformations constrained in displacements
// and volume", Computer Graphics Forum 15(3) (Eurographics), 1996: an object of masses on its
// contour evolves in two phases, forces and then constraints, "presented as reaction forces"; its
// volume "can be kept exactly constant without an iterative process". After the free step to x̂ the
// nodes move along the volume's gradient,
//
//   x⁺ = x̂ + α M⁻¹ g(x̂),   V(x̂ + α M⁻¹ g) = V*
//
// a straight line, along which V is a cubic in α: its root nearest to 0 is found in closed form.
//
// Here: M⁻¹ weights the correction, so that the reaction force keeps linear momentum (Σ g = 0).
// Being a reaction force it changes the velocities too, v⁺ = (x⁺ − x)/h, and is a pressure
// p = α/h². Contacts belong to the first phase: the projection pushes contact nodes in again, by
// h² p g/m (micrometres), which the next step's contacts undo and feel as force.
#pragma once

#include "deformation/model/organ_model.h"
#include "deformation/volume/volume_rule.h"

namespace palpate::deformation {

class Promayon : public VolumeRule {
 public:
  explicit Promayon(const OrganModel& model);
  double largest_step() const override { return largest_step_; }
  VolumeAction before_contacts(double h, const OrganState& state, FreeStep& step) override;
  bool after_step(double h, const VolumeGradient& end, OrganState& state) override;

 private:
  const OrganModel& model_;
  double largest_step_;
  VolumeGradient end_;            ///< at x̂
  std::vector<Vec3> directions_;  ///< M⁻¹ g(x̂)
};

}  // namespace palpate::deformation
