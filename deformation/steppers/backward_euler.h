// One step of an organ by backward Euler, contacts and volume inside.
//
//   M (v⁺ − v) = h (F(x⁺, v⁺) + M (gravity − drag v⁺)) − Bᵀ (impulses),   x⁺ = x + h v⁺
// by one Newton iteration from the free flight x̃ = x + h v, with the springs as they are there
// (projected_spring_stiffness.h). For Δv = v⁺ − v:
//   A Δv = h F(x̃, v) + h M (gravity − drag v) − Bᵀ (impulses)
// under the same conditions as in contact_solve.h: Φ(x̃) + h g·Δv = 0, no contact is penetrated or
// pulls, friction lies in Coulomb's cone.
//
// Solved in two movements, each with W ∝ (3×3 diagonal blocks of A)⁻¹ as the nodes' inverse
// effective mass:
//   impulses   one step down the gradient, Δv ← Δv + W r, then contacts and volume by Gauss–Seidel.
//              W is half the inverse blocks: A ⪯ 2 D, so this never overshoots. It decides which
//              contacts are closed.
//   springs    conjugate gradients with closed contacts and the volume held in every iterate
//              (constraint_projection.h), at most `iterations` of them. A has by then how friction
//              changes with the velocity (lagged_friction.h), and that triangles under a round
//              probe resist tilting (contact_tilt.h).
// and the impulses once more; then, on a fine wall, the springs about the contacts to the end, with
// what has closed by now (contact_relaxation.h), so that every condition holds at the step's end,
// however few iterations were made, and a probe feels the step it is in. What they leave of the
// residual acts on in the next step: an organ at rest is at the equilibrium of symplectic Euler,
// one that moves lags and is damped a little more.
//
// A mode of frequency ω loses by this the part 1 − 1/√(1 + h²ω²) of its amplitude per step.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "deformation/contact/constraint_projection.h"
#include "deformation/contact/lagged_friction.h"
#include "deformation/contact/starting_impulses.h"
#include "deformation/model/organ_model.h"
#include "deformation/springs/kernel/spring_kernel.h"
#include "deformation/springs/spring_hessian_product.h"
#include "deformation/steppers/contact_relaxation.h"
#include "deformation/steppers/organ_dynamics.h"
#include "modules/core/ranges.h"

namespace palpate::deformation {

class BackwardEuler : public OrganDynamics {
 public:
  static constexpr int kIterations = 12;
  /// Not for stability: contacts and volume are taken as flat over a step [s].
  static constexpr double kLargestStep = 0.01;
  /// Picard iterations of friction where a wall is fine; one more changes a press's force by less
  /// than 2 %.
  static constexpr int kFrictionPasses = 2;
  /// Gauss–Seidel at most; the second where the springs about the contacts are relaxed next and it
  /// is done again. Fewer at first, where friction comes from, would be felt: a sphere that sticks
  /// would be dragged with less force.
  static constexpr int kMostSweeps = 60, kSweepsBetween = 20;
  /// Passes over all springs in a step: forces, residual, one product per iteration.
  static constexpr int passes(int iterations) { return iterations + 2; }

  /// @param model       of springs, outlives this
  /// @param iterations  of conjugate gradients per step, at most
  /// @param runner      outlives this; none: the calling thread alone. The bits are the same
  explicit BackwardEuler(const OrganModel& model, const KeptVolume& volume = {},
                         int iterations = kIterations, ChunkRunner* runner = nullptr);

  double largest_step() const override { return kLargestStep; }
  StepReport step(double h, std::span<ContactRow> rows, OrganState& state) override;
  double elastic_energy(const OrganState& state) override {
    return kernel_.elastic_energy(state.positions);
  }

  const VolumeGradient* volume_at(const std::vector<Vec3>& positions) override {
    return volume_.is_kept ? &kernel_.volume_at(positions, free_) : nullptr;
  }

  /// Of the last step.
  int iterations_used() const { return iterations_used_; }

 private:
  /// body(i) for all nodes.
  template <class Body>
  void for_nodes(std::size_t count, const Body& body) const {
    ranges_.each(count, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) body(i);
    });
  }
  /// Σ body(i) over the nodes.
  template <class Body>
  double sum_of(std::size_t count, const Body& body) {
    return ranges_.sums(count, [&](std::size_t first, std::size_t last) {
      double sum = 0;
      for (std::size_t i = first; i < last; ++i) sum += body(i);
      return Ranges::Sums{sum, 0};
    })[0];
  }
  void solve(double h, std::span<ContactRow> rows, const OrganState& state);
  void push_with(double volume_impulse, double h, std::span<ContactRow> rows,
                 const OrganState& state);
  void linearise_springs(double h, std::span<const ContactRow> rows, const OrganState& state);
  void take_tilts(const OrganState& state);
  void linearise_friction(std::span<ContactRow> rows);
  /// Φ + h g·(v⁺ − velocities) = 0 with the volume of free_ as it would be by these velocities.
  /// @returns false if g vanished
  bool linearise_volume(double h, double target_volume, const std::vector<Vec3>& velocities);
  void take_volume_answers();
  void take_volume_answer(std::size_t node);
  /// Δv ← Δv + W r and impulses on top of it.
  void solve_impulses(double h, std::span<ContactRow> rows, const OrganState& state,
                      WarmStart start, int most_sweeps);
  /// How many nodes a kept volume moves.
  std::size_t moved_by_volume() const { return volume_row_ ? volume_answers_.size() : 0; }
  /// g·v of trial_ [m³/s]
  double volume_velocity();
  /// Turns the unconstrained velocities in trial_ into v⁺, takes Δv from it, and adds σ to the
  /// volume's impulse.
  /// @param volume_velocity  g·v of trial_ [m³/s]
  /// @param velocities       v [m/s]  (node_count)
  void hold_rows(double h, std::span<ContactRow> rows, double volume_velocity, WarmStart start,
                 int most_sweeps, const std::vector<Vec3>& velocities);
  /// r = h F − A Δv − Bᵀ (impulses)
  void update_residual(std::span<const ContactRow> rows);
  /// The same of the nodes of contacts_ alone.
  void update_local_residual(std::span<const ContactRow> rows);
  void take_impulses_from(std::span<const ContactRow> rows);
  void relax_springs(std::span<ContactRow> rows, const OrganState& state);
  void relax_contacts(double h, std::span<ContactRow> rows, const OrganState& state);
  void keep_momentum(double h, std::span<const ContactRow> rows, const OrganState& state);
  void correct_volume(double h, std::span<ContactRow> rows, OrganState& state);

  const OrganModel& model_;
  KeptVolume volume_;
  int max_iterations_, iterations_used_ = 0;
  double total_mass_ = 0;
  Ranges ranges_;
  SpringHessianProduct springs_;
  ConstraintProjection projection_;
  ContactRelaxation contacts_;
  SpringKernel kernel_;
  StartingImpulses started_;
  LaggedFriction friction_;
  std::vector<ContactCoupling> couplings_;  ///< of the contacts: tilts, then friction
  std::size_t tilt_count_ = 0;
  std::vector<std::pair<std::uint32_t, Mat3>> without_friction_;  ///< W of nodes that have some
  OrganState predicted_;                                          ///< x̃, v
  FreeStep free_;                          ///< what the springs do there in h, and the volume
  std::optional<VolumeRow> volume_row_;    ///< none: contents not kept, or g vanished
  double volume_impulse_ = 0;              ///< σ [Pa·s]
  std::vector<Mat3> inverse_mass_blocks_;  ///< W [1/kg]
  std::vector<Vec3> volume_answers_;       ///< W g [m²/kg]
  std::vector<Vec3> change_;               ///< Δv [m/s]
  std::vector<Vec3> forces_;               ///< h F, of springs and gravity [N·s]
  std::vector<Vec3> residual_;             ///< r [N·s]
  std::vector<Vec3> trial_;
  std::vector<Vec4f> inner_change_, inner_residual_, projected_, product_;
};

}  // namespace palpate::deformation
