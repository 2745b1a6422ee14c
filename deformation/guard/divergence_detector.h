// Divergence detector: whether an organ's motion is plausible.
//
// Energy. An organ cannot hold more than it had and was given. Given is, per step of h,
//   contacts   J·v⁺ of every impulse J, v⁺ the tissue's velocity after it: an upper bound, for the
//              impulse itself brought v towards its own direction (exactly: J·(v + v⁺)/2)
//   contents   p (V*⁺ − V*)
//   gravity    m g · (way of the centre of mass)
// The energy budget is the sum, and is brought down to the energy there is at every thorough check:
// what damping took cannot be had again. An explicit step beyond its bound multiplies energy in
// every step, so it passes any factor soon; time stepping within the bound makes the energy swing
// (near the bound by 1/(1 − h²ω²/4)), which kEnergyGain leaves room for.
//
// Of the contacts' work J·v_c is the probe's, v_c the velocity of its surface; the rest,
// J·(v⁺ − v_c) where positive, undoes penetrations and is injected: nobody did that work. A probe
// that appeared inside an organ may push it out once; a wall caught on a thin probe, pushed to this
// side and that in turns, would be shaken by it forever. Only pushes faster than kPushedSpeed
// count: below 0.05 m/s those of an organ pressed flat with 1 kN add up to as much, and it is as
// healthy as can be. And only those faster than the probe's surface moves: what it crosses unseen
// it would have pushed away itself, with the same work.
//
// Judged is motion about the mean: nothing inner moves the centre of mass, so what throws an organ
// as a whole is no instability of it. The energy grew if it moves faster than any probe moves it,
// or for long faster than one push can make it, and holds more, moving and stored, than at the
// check before: tenfold, or if it was as fast then, too, by more than the work done since, without
// what was injected. Tissue that springs free or was thrown only loses; a probe that drives it on
// pays. Where none was looked at before, growth is not known: then a tenth must be motion, for
// tissue crushed by a probe holds much and hardly moves. And nobody did the work: either
//   it is shaken, its surface moving so, and more was injected than one push gives; or
//   its motion is ten times what it may hold, and a tenth of what it holds or more: an unstable
//   step turns the one into the other, tissue crushed by a probe holds much and hardly moves.
// Whatever moves faster than one push can make it is looked at closely for that in every check, and
// for whether it is inside out.
//
// Elastic energy that nobody gave is suspicious, no more: a step that is not solved to the end
// leaves some in tissue crushed by a fast, small probe. The budget is never below 0: work that took
// more was overestimated.
#pragma once

#include <span>

#include "deformation/guard/advance_report.h"
#include "deformation/steppers/organ_dynamics.h"
#include "modules/core/ranges.h"
#include "modules/core/state_archive.h"
#include "modules/core/tolerances.h"

namespace palpate::deformation {

/// Nothing soft moves faster and means it [m/s].
inline constexpr double kMaxNodeSpeed = 100.0;
inline constexpr double kMaxGrowth = 5.0;
inline constexpr double kTurnedVolume = 0.05;
inline constexpr double kEnergyGain = 10.0;
inline constexpr double kSuspiciousGain = 2.0;
/// An organ with no more kinetic energy than its mass has at this speed is calm, wherever it came
/// from [m/s].
inline constexpr double kCalmSpeed = 0.05;

/// Injected energy is forgotten by 1/e in this time [s]; no more is plausible at a time than pushes
/// the whole organ out of a probe once, J·v⁺ = m kMaxSeparationSpeed².
inline constexpr double kInjectionMemory = 10.0;
/// Root mean square of how a surface's nodes moved since the last check, or of how all move now,
/// about their mean: faster than any probe moves them, or for so long faster than one push can
/// [m/s], [s].
inline constexpr double kShakenSpeed = kMaxProbeSpeed;
inline constexpr double kShakenForLongSpeed = kMaxSeparationSpeed;
inline constexpr double kShakenTime = 0.5;
/// Tissue parts from the probe faster than this where a penetration is undone in a hurry [m/s].
inline constexpr double kPushedSpeed = 0.2;

class DivergenceDetector {
 public:
  /// @param body  outlives this
  /// @param knows_energy  false: the energy budget is not kept
  /// @param runner        outlives this; none: the calling thread alone
  DivergenceDetector(const Body& body, bool knows_energy, ChunkRunner* runner = nullptr);

  /// Begins anew with `state`, whose stored energy is `elastic_energy` [J].
  void begin(const OrganState& state, double elastic_energy);

  /// Goes on where `before` was, of another mesh of the same organ: what that changes of the energy
  /// is not given to it.
  void take_over(const DivergenceDetector& before, const OrganState& state);

  /// Energy given in one step of h [s]. `state` is that after it.
  /// @param volume_change  V*⁺ − V* [m³]
  void add_work(double h, std::span<const ContactRow> rows, double volume_change,
                const OrganState& state);

  /// For every advance: one pass over the nodes; of an organ in motion also all energy and the sign
  /// of the volume.
  /// @param period  since the last check [s]
  Violation check(const OrganState& state, double period, OrganDynamics& dynamics);

  /// The same, closely in any case. Brings the energy budget down.
  Violation check_thoroughly(const OrganState& state, double period, OrganDynamics& dynamics);

  /// The last check passed, but the energy was more than it should be: a step too large shows
  /// itself so before it does harm.
  bool suspicious() const { return suspicious_; }

  double energy_budget() const { return energy_budget_; }  ///< what it may hold [J]

  void exchange(StateArchive& archive) {
    archive(energy_budget_, injected_energy_, kinetic_energy_, inner_energy_, energy_, paid_work_,
            shaking_squared_, first_moment_, shaken_time_, seen_, suspicious_, was_fast_);
  }

  /// What add_work() changes, for steps that are taken back.
  struct Ledger {
    double energy_budget = 0, injected_energy = 0, paid_work = 0;  ///< [J]
  };
  Ledger ledger() const { return {energy_budget_, injected_energy_, paid_work_}; }
  void put_back(const Ledger& ledger) {
    energy_budget_ = ledger.energy_budget;
    injected_energy_ = ledger.injected_energy;
    paid_work_ = ledger.paid_work;
  }

 private:
  /// Of some nodes.
  struct Motion {
    bool sound = true;                                    ///< within all bounds
    double twice_energy = 0, squares = 0;                 ///< kinetic [J]; of ways [m²]
    Vec3 momentum = Vec3::Zero(), moment = Vec3::Zero();  ///< [kg·m/s]; Σ m x of what moves [kg·m]
    Vec3 way = Vec3::Zero();                              ///< Σ of the surface's nodes [m]
  };
  Motion motion_of(const OrganState& state, double period);
  bool is_finite(const OrganState& state) const;
  void give(double work);
  double may_hold() const { return energy_budget_ + calm_energy_; }  ///< [J]
  Violation check_bounds(const OrganState& state, double period);
  Violation look_closely(const OrganState& state, OrganDynamics& dynamics);
  bool moves() const;
  void stop_looking();
  Violation explain(const OrganState& state, double period) const;

  const Body& body_;
  bool knows_energy_;
  Ranges ranges_;
  std::vector<Motion> motions_;  ///< of each range
  double total_mass_ = 0, largest_distance_ = 0, calm_energy_ = 0, largest_injected_energy_ = 0;
  double energy_budget_ = 0, injected_energy_ = 0, kinetic_energy_ = 0;  ///< [J]
  double inner_energy_ = 0;           ///< kinetic, about the mean [J]
  double energy_ = 0;                 ///< all, at the last check; 0: not looked at [J]
  double paid_work_ = 0;              ///< given since then, but what was injected [J]
  double shaking_squared_ = 0;        ///< kShakenSpeed's, now [m²/s²]
  double shaken_time_ = 0;            ///< faster than kShakenForLongSpeed until now [s]
  Vec3 first_moment_ = Vec3::Zero();  ///< Σ m x, under gravity [kg·m]
  std::vector<Vec3> seen_;            ///< positions of the last check [m]
  bool suspicious_ = false;
  bool was_fast_ = false;  ///< at the last check
};

}  // namespace palpate::deformation
