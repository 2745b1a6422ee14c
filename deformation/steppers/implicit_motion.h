// Motion of a solid in time by the second backward difference formula (BDF2):
//   v⁺ = (3x⁺ − 4x + x⁻)/(2h),  M (3v⁺ − 4v + v⁻)/(2h) = forces(x⁺)
// i.e. equilibrium with the inertia M (9/(4h²)) (x⁺ − x̂),  x̂ = (4x − x⁻)/3 + (2h/3)(4v − v⁻)/3.
// Second order, L-stable: what the step does not resolve, contact above all, is damped and does not
// ring. A mode ω h ≪ 1 loses (ωh)⁴/4 of its amplitude per step. The first step is backward Euler.
#pragma once

#include "deformation/steppers/equilibrium.h"

namespace palpate::elements {

class ImplicitMotion {
 public:
  /// @param solver      outlives this
  /// @param velocities  at the start [m/s]  (node_count)
  ImplicitMotion(EquilibriumSolver& solver, SolidState start, std::vector<Vec3> velocities);

  /// Advances by h > 0 [s], the same in every call. Held coordinates stay.
  EquilibriumReport step(double h);

  const SolidState& state() const { return state_; }
  const std::vector<Vec3>& velocities() const { return velocities_; }

 private:
  EquilibriumSolver& solver_;
  SolidState state_;
  std::vector<Vec3> velocities_, earlier_positions_, earlier_velocities_;
  bool first_ = true;
};

}  // namespace palpate::elements
