// The largest stable step of symplectic Euler, from the springs as they are at some positions.
//
// With v⁺ = v + h M⁻¹(−K x − C v), x⁺ = x + h v⁺, solutions grow as zⁿ where
//   (M (z−1)² + h C (z−1) + h² K z) u = 0
// Stability is lost at z = −1, a motion that turns round in every step:
//   h² K + 2 h C = 4 M      without damping h = 2/ω_max
// K is the whole derivative of the springs' forces: k u uᵀ + k (1 − l₀/l)(I − u uᵀ). A volume kept
// by a constraint leaves only motions with g·v = 0: K is projected. Power iteration finds the
// largest eigenvalue of M⁻¹(h² K + 2 h C), whose Rayleigh quotient gives the next h, and so on.
#pragma once

#include "deformation/model/organ_model.h"

namespace palpate::stability {

/// How the contents answer, beside the springs.
struct Contents {
  bool kept = false;     ///< by a constraint
  double stiffness = 0;  ///< −dp/dV of a pressure that follows the volume [Pa/m³]
};

/// @param positions  of all nodes [m]
/// @returns h [s], to about 1e-4 of it
double predicted_step(const deformation::OrganModel& model, const std::vector<Vec3>& positions,
                      const Contents& contents);

}  // namespace palpate::stability
