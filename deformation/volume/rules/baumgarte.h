// The volume constraint on accelerations, stabilised.
//
// J. Baumgarte, "Stabilization of constraints and integrals of motion in dynamical systems",
// Computer Methods in Applied Mechanics and Engineering 1, 1972: instead of Φ̈ = 0, which drifts,
//
//   Φ̈ + 2a Φ̇ + b² Φ = 0,   Φ = V − V*,   Φ̇ = g·v,   Φ̈ = g·a + ġ·v
//
// With a = M⁻¹(F − gλ) and v̂ = v + h M⁻¹F (so h g·M⁻¹F = g·v̂ − g·v), times h, and σ = h λ:
//
//   (gᵀM⁻¹g) σ = g·v̂ − g·v + h (ġ·v + 2a g·v + b² Φ)
//
// ġ·v = vᵀ(∂g/∂x)v is twice the quadratic coefficient of V along v. Contacts are solved with it, as
// with the implicit constraint. With a = b an error decays like (1 + a t) e^{−a t} and no faster:
// whatever a contact or the linearisation brings stays for about 2/a. V* counts as constant during
// a step, so V follows a ramp V̇* late by 2a/b² (40 ms).
//
// Stepped explicitly, that law ends at b² h² + 4 a h = 4 whatever the springs, which matters where
// they are soft: h < 2 (√(a² + b²) − a)/b², 16.6 ms.
#pragma once

#include "deformation/model/organ_model.h"
#include "deformation/volume/volume_rule.h"

namespace palpate::deformation {

class Baumgarte : public VolumeRule {
 public:
  static constexpr double kA = 50, kB = 50;  ///< a, b [1/s]

  /// Largest stable step of Φ̈ + 2a Φ̇ + b² Φ = 0 alone [s].
  static double law_step_bound();

  explicit Baumgarte(const OrganModel& model);
  double largest_step() const override { return largest_step_; }
  bool reads_gradient() const override { return true; }
  VolumeAction before_contacts(double h, const OrganState& state, FreeStep& step) override;

 private:
  const OrganModel& model_;
  double largest_step_;
};

}  // namespace palpate::deformation
