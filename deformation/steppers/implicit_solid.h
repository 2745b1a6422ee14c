// One step of a solid by backward Euler: one Newton iteration from the free flight x̃ = x + h v,
//   A Δv = h F(x̃) + h M (gravity − drag v) − Bᵀ (impulses),   A = (1 + h·drag) M + h² K(x̃)
// by rounds of conjugate gradients, the contacts inside (implicit_solid_contacts.h). What the
// iterations leave of the residual acts on in the next step: equilibria are those of F, however few
// iterations are made.
//
// There is no global volume constraint: tissue keeps its volume by what it is made of, and
// state.target_volume is not looked at.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "deformation/contact/implicit_solid_contacts.h"
#include "deformation/steppers/organ_dynamics.h"
#include "modules/core/wide_vectors.h"

namespace palpate::deformation {

/// Elastic forces of a solid and how they answer small velocities. Keeps no state but buffers.
class ImplicitTissue {
 public:
  virtual ~ImplicitTissue() = default;

  /// Takes forces and A at these positions [m] (node_count) for a step of h [s].
  virtual void linearise(const std::vector<Vec3>& positions, double h) = 0;

  virtual const std::vector<Vec3>& forces() const = 0;    ///< F [N]  (node_count)
  virtual const std::vector<Mat3>& diagonal() const = 0;  ///< 3×3 blocks D of A [kg]  (node_count)

  /// out = A p, symmetric and positive definite. Rows of fixed nodes are like any other.
  /// @param p    [m/s]  (node_count)
  /// @param out  [N·s]  (node_count)
  virtual void apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) = 0;

  virtual double energy(const std::vector<Vec3>& positions) = 0;  ///< [J]
};

class ImplicitSolid : public OrganDynamics {
 public:
  /// Not for stability: contacts are taken as flat over a step [s].
  static constexpr double kLargestStep = 0.01;

  /// @param model       outlives this
  /// @param iterations  of conjugate gradients per step, at most
  ImplicitSolid(const OrganModel& model, std::unique_ptr<ImplicitTissue> tissue, int iterations);

  double largest_step() const override { return kLargestStep; }
  StepReport step(double h, std::span<ContactRow> rows, OrganState& state) override;
  double elastic_energy(const OrganState& state) override {
    return tissue_->energy(state.positions);
  }

  int iterations_used() const { return iterations_used_; }  ///< of the last step

 private:
  void linearise(double h, const OrganState& state);
  /// Δv and the contacts' impulses together.
  void solve(double h, std::span<ContactRow> rows, const OrganState& state);
  void take_preconditioner(std::span<const ContactRow> rows);
  void take_residual(std::span<const ContactRow> rows);
  bool conjugate_gradients(int iterations, std::span<const ContactRow> rows);
  void precondition();
  void keep_momentum(double h, std::span<const ContactRow> rows, const OrganState& state);
  double mean_pressure() const;

  const OrganModel& model_;
  std::unique_ptr<ImplicitTissue> tissue_;
  int max_iterations_, iterations_used_ = 0;
  double total_mass_ = 0;
  ImplicitSolidContacts contacts_;
  std::vector<Vec3> flight_;                          ///< x̃ [m]
  std::vector<Vec3> velocities_;                      ///< v + Δv [m/s]
  std::vector<Mat3> mobilities_;                      ///< D⁻¹, of A without contacts [1/kg]
  std::vector<Mat3> diagonal_;                        ///< with contacts [kg]
  std::vector<std::array<Vec4f, 3>> preconditioner_;  ///< its inverse blocks, by columns
  std::vector<Vec4f> change_;                         ///< Δv [m/s]
  std::vector<Vec4f> load_;                           ///< right-hand side without contacts [N·s]
  std::vector<Vec4f> residual_;                       ///< r [N·s]
  std::vector<Vec4f> projected_, direction_, product_;
};

}  // namespace palpate::deformation
