// Neo-Hookean tetrahedra by extended position-based dynamics.
//   M. Macklin, M. Müller, "A Constraint-based Formulation of Stable Neo-Hookean Materials",
//   MIG 2021;  steps as in xpbd_springs.h.
//
// The tissue is that of materials/stable_neo_hookean.h with λ for its λ̂,
//   ψ(F) = μ/2 (tr FᵀF − 3) + λ/2 (J − 1 − μ/λ)² − μ²/(2λ)
// Per tetrahedron of volume V two constraints and compliances:
//   C_D = √(tr FᵀF),        α_D = 1/(μ V h²),   ∂C_D/∂F = F/C_D
//   C_H = J − 1 − μ/λ,      α_H = 1/(λ V h²),   ∂C_H/∂F = cofactor of F
// At rest neither vanishes, but their forces cancel. So that an organ at rest stays there, both are
// solved at once, a 2×2 system per visit.
//
// Only what the two gradients span is implicit. The rest of the shear stiffness, F ↦ μ V F of C_D
// across its gradient, is met where it was, so the method has a largest step like an explicit one:
// it falls as 1/√μ and with the mesh, and λ does not move it.
//
// Linear tetrahedra lock as ν goes to ½: near it the organ is too stiff in shape. On top of that
// one visit per step leaves stresses unbalanced; both errors are measured, not corrected.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "deformation/elements/linear_tetrahedra.h"
#include "deformation/materials/stable_neo_hookean.h"
#include "deformation/model/tet_mesh.h"
#include "deformation/steppers/organ_dynamics.h"

namespace palpate::deformation {

class XpbdTetrahedra : public OrganDynamics {
 public:
  /// For accuracy: never more [s].
  static constexpr double kStep = 5e-4;
  /// Of 2/ω, ω² Gershgorin's bound of the shear stiffness alone. Free balls of 80 to 5792
  /// tetrahedra and ν from 0 to 0.49 swing stably up to 1.78 … 4.3 of it.
  static constexpr double kStepOfBound = 1.5;

  /// @param body        outlives this
  /// @param mesh        of linear tetrahedra, ν < ½
  /// @param iterations  passes over the tetrahedra in each step, ≥ 1
  XpbdTetrahedra(const Body& body, const TetMesh& mesh, int iterations = 1);

  double largest_step() const override { return largest_step_; }
  StepReport step(double h, std::span<ContactRow> rows, OrganState& state) override;
  void add_stiffness(const Patch& patch, Eigen::MatrixXf& sum) const override;
  /// ∫ ψ(F) − ψ(1) dV₀ [J]
  double elastic_energy(const OrganState& state) override;

 private:
  /// Of M⁻¹K, K the shear stiffness μ V ∇N_i·∇N_j alone [rad²/s²].
  double squared_frequency_bound() const;
  Mat3 deformation_gradient(std::size_t element, const std::vector<Vec3>& positions) const;
  /// @returns V times the mean stress, of which compression is negative [J]
  double relax(std::size_t element, double h);

  const Body& body_;
  int iterations_;
  std::vector<std::array<double, 2>> multipliers_;  ///< λ_D, λ_H of this step  (tetrahedra)
  StableNeoHookean law_;                            ///< μ, λ: its μ, λ̂
  LinearTetrahedra tetrahedra_;
  double largest_step_ = kStep;
  std::vector<Vec3> positions_, velocities_;
};

}  // namespace palpate::deformation
