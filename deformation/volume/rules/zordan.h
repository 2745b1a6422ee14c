// Pressure of pyramids over the surface's triangles.
//
// V. B. Zordan, B. Celly, B. Chiu, P. C. DiLorenzo, "Breathe easy: model and control of simulated
// respiration for animation", SCA 2004, keep the volume of the gut of a breathing torso by pressure
// on a deformable surface whose volume is summed over pyramids. Only the abstracts were at hand
// when this was written, so this is a reading of the idea, not their code.
//
// Here: each triangle t with its pyramid (pyramids.h) has a pressure of its own from the volume its
// pyramid has lost,
//
//   p_t = K (V_t* − V_t)/(s_t V₀),   F_i = p_t ∂V_t/∂x_i,   V_t* = V_t₀ V*/V₀
//
// s_t the triangle's share of the rest area, so that a flat or inverted pyramid of a concave organ
// has no infinite stiffness. A uniform inflation is answered like a penalty of modulus K. The apex
// takes the reaction, so momentum is kept. Pressure being local, a push is answered where it is:
// the contents do not flow to where there is room, and the organ is stiffer than one filled with
// fluid.
//
// The largest step is that at rest. Triangles that stretch see more of their pressure, and it
// falls: a ball stands three times the step it is given while at rest, just that step when squeezed
// to 0.3 of its height, and 0.6 of it at 0.1. That is not counted: no organ is meant to be pressed
// so far by this method.
#pragma once

#include "deformation/model/organ_model.h"
#include "deformation/volume/rules/pyramids.h"
#include "deformation/volume/volume_rule.h"

namespace palpate::deformation {

class Zordan : public VolumeRule {
 public:
  static constexpr double kModulus = 10e3;  ///< K [Pa]

  /// @param model  has virtual nodes
  explicit Zordan(const OrganModel& model);
  double largest_step() const override { return largest_step_; }
  VolumeAction before_contacts(double h, const OrganState& state, FreeStep& step) override;
  double stored_energy(const OrganState& state) const override;  ///< Σ ½ p_t (V_t* − V_t) [J]

 private:
  double stiffness(const Pyramid& pyramid) const;  ///< dp_t/dV_t = K/(s_t V₀) [Pa/m³]
  /// Gershgorin's bound of M⁻¹K of the pyramids at rest [rad²/s²].
  double squared_frequency_bound() const;

  const OrganModel& model_;
  std::vector<Pyramid> pyramids_;
  double largest_step_ = 0;
};

}  // namespace palpate::deformation
