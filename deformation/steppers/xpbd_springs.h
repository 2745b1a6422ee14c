// Springs as compliant distance constraints, by extended position-based dynamics.
//   M. Macklin, M. Müller, N. Chentanez, "XPBD: Position-Based Simulation of Compliant Constrained
//   Dynamics", MIG 2016;  M. Macklin et al., "Small Steps in Physics Simulation", SCA 2019: many
//   short steps of one iteration.
//
// From the free flight x = xₙ + h (v + h·gravity)/(1 + h·drag), every spring, one after another,
// with C = |x_b − x_a| − l₀, α = 1/(k h²), γ = c/(k h) (its damping), w = 1/m_a + 1/m_b, λ at first
// 0:
//   Δλ = −(C + γ u·(Δx_b − Δx_a) + α λ) / ((1 + γ) w + α),  λ ← λ + Δλ,  x ← x + M⁻¹∇CᵀΔλ,
//   Δx = x − xₙ
// The volume and the contacts, constraints of no compliance, follow together, solved to the end
// (contact_solve.h) on the velocities (x − xₙ)/h: the contents are kept whatever the springs do.
//
// once, or as many times as the scene's `iterations` says: then backward Euler's step is
// approached, at the price of as many passes. One visit meets a spring as if alone in the world:
// the answer to a sum of springs comes out softer, for short steps by about h²ω² of the local
// frequency ω. The number of passes over the springs per second is that of an explicit method; but
// no stiffness is too much.
#pragma once

#include <span>
#include <vector>

#include "deformation/springs/kernel/spring_visits.h"
#include "deformation/steppers/organ_dynamics.h"

namespace palpate::deformation {

class XpbdSprings : public OrganDynamics {
 public:
  /// For accuracy alone [s].
  static constexpr double kStep = 5e-4;

  /// @param model  of springs, outlives this
  /// @param iterations  passes over the springs in each step, ≥ 1
  explicit XpbdSprings(const OrganModel& model, int iterations = 1)
      : model_(model), iterations_(iterations), visits_(model), kernel_(model) {}

  double largest_step() const override { return kStep; }
  StepReport step(double h, std::span<ContactRow> rows, OrganState& state) override;
  double elastic_energy(const OrganState& state) override;

 private:
  const OrganModel& model_;
  int iterations_;
  SpringVisits visits_;
  SpringKernel kernel_;
  FreeStep free_;
  std::vector<Vec3> positions_;
};

/// (v + h·gravity)/(1 + h·drag), zero where nodes are fixed  (node_count)
void free_flight(const Body& body, double h, const OrganState& state,
                 std::vector<Vec3>& velocities);

}  // namespace palpate::deformation
