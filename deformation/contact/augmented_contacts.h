// Contacts inside an implicit step, as stiff springs and dampers that only press and rub:
//   j = max(0, j₀ + ρ (n·(Σ b v⁺ − v_c) − gap/h)),   t = t₀ − ρ s, cut off at a bound
// with s the sliding and j₀, t₀ the impulses of the step before (an augmented Lagrangian, one round
// per step): what is held keeps its place, what sticks does not creep. The bound is friction·j, of
// the iterate before. With a given bound these impulses have a convex potential, quadratic in
// pieces: so a solver that goes downhill as far as it falls, each time by step_length(), ends with
// the right contacts whichever it began with, and what it has found by then are impulses at
// velocities, none of a guess. Contacts may depend on each other: they share their force. A contact
// whose force changes by Δj in a step is penetrated by h Δj/ρ: where that is too much, go_on()
// begins another round, else the next step does.
#pragma once

#include <span>
#include <vector>

#include "deformation/contact/contact_solve.h"
#include "modules/core/simd_vectors.h"

namespace palpate::deformation {

class AugmentedContacts {
 public:
  /// Begins at these velocities [m/s], and sets the rows' impulses to those there.
  /// @param inverse_mass_blocks  inverse 3×3 blocks of A, zero for fixed nodes [1/kg]  (node_count)
  void begin(std::span<const Mat3> inverse_mass_blocks, std::span<ContactRow> rows, double h,
             const std::vector<Vec3>& velocities);

  /// Begins another round from these impulses: what is still penetrated, or slides within its cone,
  /// is held by as much more.
  void go_on(std::span<ContactRow> rows);

  /// Takes the direction p in which velocities will go next  (node_count).
  void set_direction(std::span<const ContactRow> rows, const std::vector<Vec4f>& p);
  /// How far along it the energy of nodes and contacts falls.
  /// @param descent    r·p, of the residual r with the rows' impulses in it
  /// @param curvature  p·A p, without contacts
  double step_length(std::span<const ContactRow> rows, double descent, double curvature) const;
  /// Goes so far and sets the rows' impulses.
  /// @param product  A p; gets what of it is the contacts', so that r falls by length · product
  /// @returns whether other contacts press than before, or friction is much different
  bool advance(std::span<ContactRow> rows, double length, std::vector<Vec4f>& product);

  /// r += Σ b (impulse) [N·s]
  void add_impulses(std::span<const ContactRow> rows, std::vector<Vec4f>& r) const;

  /// The 3×3 blocks of what the impulses lose by velocities, into those of A [kg]  (node_count).
  void add_to_diagonal(std::span<const ContactRow> rows, std::vector<Mat3>& diagonal) const;

 private:
  struct Spring {
    double stiffness = 0;         ///< ρ [kg]; 0: all nodes fixed
    double allowed_approach = 0;  ///< [m/s]
    Yielding yielding;
    double last_pressing = 0;           ///< j₀ [N·s]
    Vec3 last_friction = Vec3::Zero();  ///< t₀ [N·s]
    double bound = 0;                   ///< of t [N·s]
    Vec3 relative = Vec3::Zero();       ///< velocity of the tissue, seen from the probe [m/s]
    Vec3 direction = Vec3::Zero();      ///< the same of p
    double friction = 0;                ///< σ = ρ |t|/|t₀ − ρ s| there [kg]
    double pressing = 0;                ///< as of an Impulse [kg]; 0: does not press
  };
  /// Of a row at a relative velocity.
  struct Impulse {
    double normal = 0;             ///< j [N·s]
    double pressing = 0;           ///< by how much it falls with the approach [kg]
    Vec3 friction = Vec3::Zero();  ///< t [N·s]
    double sliding = 0;            ///< σ [kg]
  };

  static Impulse normal_at(const ContactRow& row, const Spring& spring, const Vec3& relative);
  static Impulse impulse_at(const ContactRow& row, const Spring& spring, const Vec3& relative);
  /// Sets the row's impulses at where it is, and the bound for what comes next.
  static void press(ContactRow& row, Spring& spring);

  std::vector<Spring> springs_;  ///< by row
};

}  // namespace palpate::deformation
