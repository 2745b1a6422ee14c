// Springs as compliant distance constraints, by extended position-based dynamics.
//   M. Macklin, M. Müller, N. Chentanez, "XPBD: Position-Based Simulation of Compliant Constrained
//   Dynamics", MIG 2016;  M. Macklin et al., "Small Steps in Physics Simulation", SCA 2019: many
//   short steps of one iteration.
//
// A step begins with the inertial prediction x = xₙ + h (v + h (gravity − drag v)): drag of a
// velocity that is known takes nothing of a weight at rest. Then every spring is visited, one after
// another. With C = |x_b − x_a| − l₀, compliance α = 1/(k h²), damping γ = c/(k h), w = 1/m_a +
// 1/m_b, Δx = x − xₙ and λ at first 0, a visit is
//   Δλ = −(C + γ u·(Δx_b − Δx_a) + α λ) / ((1 + γ) w + α),  λ ← λ + Δλ,  x ← x + M⁻¹∇CᵀΔλ
// Volume and contacts, constraints of no compliance, follow together and are solved to the end
// (contact_solve.h) on the velocities (x − xₙ)/h: the contents are kept whatever the springs do.
//
// The scene's `iterations` says how often all springs are visited, 1 if it says nothing; more
// approach a step of backward Euler. A visit sees its spring alone, so that springs together answer
// too softly, for short steps by about h²ω² of the local frequency ω. Passes over the springs per
// second are as many as an explicit method needs; but no stiffness is too much.
#pragma once

#include <span>
#include <vector>

#include "deformation/model/organ_model.h"
#include "deformation/springs/kernel/spring_gauss_seidel.h"
#include "deformation/steppers/organ_dynamics.h"

namespace palpate::deformation {

class XpbdSprings : public OrganDynamics {
 public:
  /// For accuracy alone [s].
  static constexpr double kStep = 5e-4;

  /// @param model  of springs, outlives this
  /// @param iterations  passes over the springs in each step, ≥ 1
  /// @param volume      may be left free; corrections are not made
  explicit XpbdSprings(const OrganModel& model, int iterations = 1, const KeptVolume& volume = {})
      : model_(model),
        iterations_(iterations),
        volume_(volume),
        visits_(model, model.network()),
        kernel_(model, model.network(), volume.is_kept) {}

  double largest_step() const override { return kStep; }
  StepReport step(double h, std::span<ContactRow> rows, OrganState& state) override;
  double elastic_energy(const OrganState& state) override;

 private:
  const OrganModel& model_;
  int iterations_;
  KeptVolume volume_;
  SpringGaussSeidel visits_;
  SpringKernel kernel_;
  FreeStep free_;
  std::vector<Vec3> positions_;
};

/// v + h (gravity − drag v), zero where nodes are fixed  (node_count) [m/s]
void inertial_prediction(const Body& body, double h, const OrganState& state,
                         std::vector<Vec3>& velocities);

}  // namespace palpate::deformation
