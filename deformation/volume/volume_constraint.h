// The volume of an organ kept by one implicit constraint, solved by a scalar division.
//
// M. Hong et al., "Modeling Volume-Preserved Human Organs for Surgical Simulation":
//   Φ(q,t) = V(q) − V*(t),  semi-implicit Euler with a multiplier λ along g = ∂V/∂q:
//   v⁺ = v + h M⁻¹(F − g λ),   q⁺ = q + h v⁺,   Φ + Φ_t h + g·(q⁺ − q) = 0
// Substituting q⁺ − q = h v + h² M⁻¹F − h² M⁻¹g λ gives one scalar equation:
//   (gᵀM⁻¹g) λ = Φ/h² + Φ_t/h + g·(v/h + M⁻¹F)
// λ is minus the pressure of the contents: p = −λ [Pa].
//
// In velocities, with v̂ = v + h M⁻¹F (unconstrained) and σ = h λ [Pa·s], Φ_t = −dV*/dt:
//   (gᵀM⁻¹g) σ = (Φ + h Φ_t)/h + g·v̂,     v⁺ = v̂ − M⁻¹g σ
// which is the form used here, because contacts enter it as further impulses on v̂.
#pragma once

#include "deformation/model/volume_gradient.h"

namespace palpate::deformation {

/// Below this fraction of its rest value gᵀM⁻¹g is taken as vanished (a surface flattened or held
/// all over): no multiplier can change the volume, and the step goes on without one.
inline constexpr double kVanishedDenominator = 1e-6;

/// How a stepper of springs keeps the volume by this constraint.
struct KeptVolume {
  bool is_kept = true;
  int corrections = 0;  ///< Newton corrections at each step's end
};

}  // namespace palpate::deformation
