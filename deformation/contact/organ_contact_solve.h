// Contacts of organs with each other and with themselves, and those of probes beside them, solved
// together when every organ has made its step.
//
// A contact is a place on one organ and a place on another, or on the same: Σ a_k x_k and Σ b_k
// x_k, with n from the first to the second. An impulse j n + t acts on the second and its negative
// on the first, so momentum is kept to rounding, whatever the iterations left. With u the nodes'
// velocities over the step, W = M⁻¹ and one multiplier σ per organ whose volume is kept (g =
// ∂V/∂x),
//     u⁺ = u + W (Cᵀ impulses − g σ),   g·(u⁺ − u) = 0
//     n·(Σ b_k u⁺_k − Σ a_k u⁺_k) ≥ −approach,   j ≥ 0,   |t| ≤ friction·j against sliding
// by projected Gauss–Seidel on the contacts with σ eliminated, as in contact_solve.h. A probe's
// contact is one whose second place moves as the probe does. For an explicit step, whose positions
// are x + h u, this is the same as having all contacts in it.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "deformation/contact/contact_solve.h"

namespace palpate::deformation {

/// A place on an organ: Σ w_k x_k, w_k ≥ 0, sum 1; unused nodes weigh 0.
struct OrganPlace {
  std::uint32_t organ = 0;
  std::array<std::uint32_t, 3> nodes{};
  Vec3 weights = Vec3::Zero();
};

struct OrganContactRow {
  std::array<OrganPlace, 2> places;    ///< without a node in common
  Vec3 normal = Vec3::UnitZ();         ///< n, unit, from the first place to the second
  double approach = 0;                 ///< how fast they may come nearer [m/s]
  double friction = 0;                 ///< Coulomb coefficient
  Vec3 probe_velocity = Vec3::Zero();  ///< of the second place, where it is a probe's [m/s]
  Yielding yielding;                   ///< of a probe's
  bool applied = false;                ///< the impulses it starts from are in u
  // In: impulses to start from. Out: the solution, on the second place [N·s].
  double normal_impulse = 0;               ///< j ≥ 0
  Vec3 tangential_impulse = Vec3::Zero();  ///< ⟂ n, norm ≤ friction·j

  Vec3 impulse() const { return normal_impulse * normal + tangential_impulse; }
};

/// An organ as contacts with organs see it.
struct TouchedOrgan {
  const Body* body = nullptr;
  std::vector<Vec3> velocities;            ///< u, becomes u⁺ [m/s]  (node_count)
  const VolumeGradient* volume = nullptr;  ///< at the step's end; none: V is not kept
  double volume_impulse = 0;               ///< out: σ [Pa·s]
};

struct OrganContactReport {
  int sweeps = 0;
  bool converged = true;
};

/// Contacts are solved when no sweep changes the velocity of one by more than this: 0.1 µm in a
/// step of a millisecond [m/s].
inline constexpr double kOrganVelocityTolerance = 1e-4;

/// A gap below 0 is opened by this part of itself in a step, no faster than kOpeningSpeed [m/s].
inline constexpr double kOpenedInStep = 0.2;
inline constexpr double kOpeningSpeed = 0.05;

/// How fast tissue may come nearer to tissue in a step of h [s] [m/s].
/// @param gap  at its start, less the distance they rest at [m]
inline double allowed_approach(double gap, double h) {
  return gap >= 0 ? gap / h : std::max(kOpenedInStep * gap / h, -kOpeningSpeed);
}

/// A probe's contact as it was solved in the step of an organ.
OrganContactRow row_of_probe(std::uint32_t organ, const ContactRow& contact, double h);
/// Gives it the impulses found.
void take_impulses(const OrganContactRow& row, ContactRow& contact);

/// Relative velocity of a row's places, of the second seen from the first [m/s].
Vec3 relative_velocity(const OrganContactRow& row, std::span<const TouchedOrgan> organs);

OrganContactReport solve_organ_contacts(std::span<OrganContactRow> rows,
                                        std::span<TouchedOrgan> organs);

}  // namespace palpate::deformation
