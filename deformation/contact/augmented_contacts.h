// Contacts inside an implicit step, as stiff springs and dampers that only press and rub:
//   j = max(0, j₀ + ρ (n·(Σ b v⁺ − v_c) − gap/h)),   t = t₀ − ρ s, cut off at friction·j
// with s the sliding and j₀, t₀ the impulses of the step before (an augmented Lagrangian, one round
// per step): what is held keeps its place, what sticks does not creep. Piecewise linear in v⁺, so
// that Newton's method needs a few rounds; each adds to A, of the contacts that press,
// b (ρ nnᵀ + σ (I − nnᵀ)) b with σ = ρ |t|/|t₀ − ρ s| of the round before (lagged, so that friction
// always brakes). Contacts may depend on each other: they share their force. A contact whose force
// changes by Δj in a round is penetrated by h Δj/ρ: where that is too much, go_on() begins another
// round, else the next step does.
#pragma once

#include <span>
#include <vector>

#include "deformation/contact/contact_solve.h"
#include "modules/core/simd_vectors.h"

namespace palpate::deformation {

class AugmentedContacts {
 public:
  /// Takes as pressing the contacts that pressed in the last step, by the impulses they bring, and
  /// those penetrated by these velocities [m/s].
  /// @param inverse_mass_blocks  inverse 3×3 blocks of A, zero for fixed nodes [1/kg]  (node_count)
  void begin(std::span<const Mat3> inverse_mass_blocks, std::span<ContactRow> rows, double h,
             const std::vector<Vec3>& velocities);

  /// Sets the rows' impulses to those at these velocities [m/s].
  /// @returns whether other contacts press than before, or friction is much different
  bool update(std::span<ContactRow> rows, const std::vector<Vec3>& velocities);

  /// Begins another round from these impulses: what is still penetrated at these velocities, or
  /// slides within its cone, is held by as much more.
  void go_on(std::span<ContactRow> rows, const std::vector<Vec3>& velocities);

  /// r += Σ b (impulse) [N·s]
  void add_impulses(std::span<const ContactRow> rows, std::vector<Vec4f>& r) const;

  /// out += what the impulses lose by velocities p.
  void apply(std::span<const ContactRow> rows, const std::vector<Vec4f>& p,
             std::vector<Vec4f>& out) const;

  /// The 3×3 blocks of that, into those of A [kg]  (node_count).
  void add_to_diagonal(std::span<const ContactRow> rows, std::vector<Mat3>& diagonal) const;

 private:
  struct Spring {
    double stiffness = 0;               ///< ρ [kg]; 0: all nodes fixed
    double allowed_approach = 0;        ///< [m/s]
    double friction = 0;                ///< σ [kg]
    double last_pressing = 0;           ///< j₀ [N·s]
    Vec3 last_friction = Vec3::Zero();  ///< t₀ [N·s]
    bool presses = false;
  };

  /// Sets the row's impulses and whether it presses. @returns σ [kg]
  double press(ContactRow& row, const std::vector<Vec3>& velocities, Spring& spring) const;

  /// Sets the row's friction under a normal impulse. @returns σ [kg]
  static double friction_update(ContactRow& row, const Vec3& relative, double pressing,
                                const Spring& spring);

  std::vector<Spring> springs_;  ///< by row
};

}  // namespace palpate::deformation
