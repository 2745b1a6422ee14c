// Contacts inside the volume solve.
//
// Unknowns of one step: the volume impulse σ (one equation) and per contact a normal impulse
// j ≥ 0 and a tangential impulse within Coulomb's cone. The tissue point of a contact is
// Σ b_k x_k; the probe's plane moves with velocity v_c. With w the node velocities including all
// contact impulses, the node velocities are v⁺ = w − M⁻¹g σ and
//     σ(w) = ((Φ + h Φ_t)/h + g·w) / (gᵀM⁻¹g)                            (volume_constraint.h)
//     non-penetration:  n·(v_c − Σ b_k v⁺_k) ≥ −gap/h                    (n from tissue to probe)
// Projected Gauss–Seidel runs on the contacts alone, with σ eliminated exactly (a rank-one update
// of each contact's inverse mass); or, where each contact acts on one node, with σ held during a
// sweep and found by Newton between sweeps. Contacts without friction on a node each need no sweeps
// (independent_contacts.h). σ is taken last, from the impulses there are: so the
// linearised volume holds however few sweeps were made; they only sharpen the contact impulses.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "deformation/volume/volume_constraint.h"

namespace palpate::deformation {

/// One contact for one step.
struct ContactRow {
  std::array<std::uint32_t, 3> nodes{};
  Vec3 weights = Vec3::Zero();  ///< barycentric b_k
  Vec3 normal = Vec3::UnitZ();  ///< n, unit, from tissue to probe
  double gap = 0;               ///< n·(probe point − tissue point) at the step's start [m]
  Vec3 probe_velocity = Vec3::Zero();  ///< v_c of the probe's surface there [m/s]
  double friction = 0;                 ///< Coulomb coefficient
  double radius = 0;                   ///< of a round probe; 0: flat [m]
  /// How far the fixed nodes that carry its place, too, give way to 1 N; 0: none does [m/N]
  double yielding = 0;
  double full_gap = 0;  ///< of one that yields: the gap, however slowly it may be closed [m]
  // In: impulses to start from (those of the last step). Out: the solution.
  double normal_impulse = 0;               ///< j ≥ 0, on the tissue along −n [N·s]
  Vec3 tangential_impulse = Vec3::Zero();  ///< on the tissue, ⟂ n, norm ≤ friction·j [N·s]
};

/// What the row's nodes have (positions, velocities), interpolated to its place on the tissue.
inline Vec3 at_tissue(const ContactRow& row, std::span<const Vec3> of_nodes) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 3; ++k) sum += row.weights[k] * of_nodes[row.nodes[k]];
  return sum;
}

/// What the volume solve needs of this step; absent for plain mass-spring.
struct VolumeRow {
  const VolumeGradient& at;
  double rate = 0;  ///< (Φ + h Φ_t)/h [m³/s]
};

struct ContactSolveReport {
  int sweeps = 0;
  double volume_impulse = 0;    ///< σ [Pa·s]
  bool volume_skipped = false;  ///< gᵀM⁻¹g vanished
};

/// Penetration is undone no faster than this [m/s], so that a probe which jumps does not shoot the
/// tissue away; the remaining depth follows in the next steps.
inline constexpr double kMaxSeparationSpeed = 1.0;
/// The same where tissue was put into a probe, or a probe into tissue, without either moving
/// [m/s]: pushed out in a hurry, tissue would swing, or fail again.
inline constexpr double kGentleSpeed = 0.05;

/// Contacts are solved when no sweep changes the velocity of one by more than this [m/s].
inline constexpr double kContactVelocityTolerance = 1e-9;

/// A contact was not solved if its tissue ends a step deeper in the probe than it may, by more than
/// this [m]. No node is to be further beyond a plate.
inline constexpr double kUnsolvedDepth = 5e-5;

/// How fast tissue may come nearer to the probe in a step of h [s] [m/s].
inline double allowed_approach(const ContactRow& row, double h) {
  return std::max(row.gap / h, -kMaxSeparationSpeed);
}

/// How a row yields whose place fixed nodes carry, too: it needs that much less of tissue that can
/// move.
struct Yielding {
  double inverse_mass = 0;  ///< of what is fixed, as a step sees it [1/kg]; 0: it does not yield
  double withheld = 0;      ///< speed by which its gap is closed more slowly than it might be [m/s]
};

inline Yielding yielding_of(const ContactRow& row, double h) {
  if (!(row.yielding > 0)) return {};
  return {row.yielding / (h * h), allowed_approach(row, h) - row.full_gap / h};
}

/// How much deeper in its probe a row's tissue ends a step of h [s] than it may [m]; 0 where it is
/// fixed.
/// @param velocities  of the nodes in the step
double excess_depth(const Body& body, const ContactRow& row, double h,
                    std::span<const Vec3> velocities);

/// Whether the impulses that the rows bring are yet to be applied to the velocities, or have been;
/// kFrictionKept: they have been, and friction of rows that press stays, but within its cone.
enum class WarmStart { kToApply, kApplied, kFrictionKept };

/// Turns unconstrained velocities v̂ (in `velocities`) into v⁺.
/// Sweeps end when no contact velocity changes by more than 1e-9 m/s, or after 60.
ContactSolveReport solve_contacts_and_volume(const Body& body, const VolumeRow* volume, double h,
                                             std::span<ContactRow> rows,
                                             std::vector<Vec3>& velocities,
                                             WarmStart start = WarmStart::kToApply);

/// The same for a caller that knows g·v̂ and itself takes the volume's impulse: turns v̂ into w.
/// @param volume_velocity  g·v̂ [m³/s]
ContactSolveReport solve_contacts(const Body& body, const VolumeRow* volume, double volume_velocity,
                                  double h, std::span<ContactRow> rows,
                                  std::vector<Vec3>& velocities,
                                  WarmStart start = WarmStart::kToApply);

/// The same where a node answers an impulse not by M⁻¹ but by a matrix W, as in implicit steps.
/// @param inverse_mass_blocks  W, symmetric, positive; zero for fixed nodes [1/kg]  (node_count)
/// @param volume      with gᵀWg of these as denominator, not vanished; or null
/// @param most_sweeps  ≥ 1
ContactSolveReport solve_contacts(std::span<const Mat3> inverse_mass_blocks,
                                  const VolumeRow* volume, double volume_velocity, double h,
                                  std::span<ContactRow> rows, std::vector<Vec3>& velocities,
                                  WarmStart start, int most_sweeps);

}  // namespace palpate::deformation
