// How implicit steps resist a change of volume: with a part of the tissue's bulk modulus at once,
// while what pressed before goes on pressing.
//
// Tissue resists a change of volume a hundred times as hard as one of shape, and conjugate
// gradients take long for it. So elements remember their pressure, and a step ends with
//   p⁺ = (1 − s) p + s κ' ε(x⁺),   ε the growth of the volume
// an augmented Lagrangian, one round per step, as contacts are (contact/augmented_contacts.h). At
// rest p = κ' ε, as without. A pressure that grows by Δp in each step is Δp (1 − s)/s behind. What
// pressed before does not fit tissue that is crushed or inside out, and would drive it: there
// elements resist with all of κ', by a share that grows evenly with ε².
//   M. Fortin, R. Glowinski, Augmented Lagrangian Methods, 1983.
//
// What gives way at once and pushes later feeds the waves of volume that steps resolve. One of wave
// number k moves by ρ (x⁺ − 2x + x₋)/h² = −k p⁺ with ε = k x, and grows where
//   K = h² κ' k²/ρ < 1/s − 2
// for at equality x ∝ exp(iθn) with cos θ = 1/(2 − 2s) solves it. Of all bodies of a volume with a
// free surface the ball has the longest wave, k = π/R (G. Faber 1923, E. Krahn 1925); what is held
// reflects it, so a quarter of that K is counted on. A half is stable whatever K.
#pragma once

#include "deformation/elements/elastic_force_elements.h"
#include "deformation/model/body.h"
#include "deformation/model/organ_state.h"

namespace palpate::deformation {

class AugmentedPressures {
 public:
  /// s κ'/μ is at least so much: half of it would spare few iterations and leave pressures twice as
  /// late.
  static constexpr double kLeastOverShear = 10;
  /// ε at which half of what is left of κ' resists at once, too. At 0.1 shaken cubes with
  /// tetrahedra inside out swing for seconds, at 0.2 they burst; at 0.05 a rod at 2.5 m/s was lost
  /// in tissue it crushed.
  static constexpr double kTame = 0.02;

  explicit AugmentedPressures(const Body& body);

  /// s of a step of h [s], in (0, 1]: the least that feeds no wave. @param pressures  κ' > 0
  double share(double h, const ElementPressures& pressures) const;

  /// Before linearise(): elements go on from the state's pressures; of a state that has none, from
  /// those of its shape.
  void begin(double h, OrganState& state, ElasticForceElements& elements);
  /// The same of a step that is not made, with s for crushed tissue, too. A state without pressures
  /// goes on from what was begun last.
  void begin_evenly(double h, const OrganState& state, ElasticForceElements& elements);
  /// After the step.
  void end(OrganState& state, ElasticForceElements& elements);

 private:
  void go_on_from(const Eigen::VectorXd& pressures, ElasticForceElements& elements);

  double density_ = 0;              ///< [kg/m³]
  double squared_wave_number_ = 0;  ///< a quarter of k² [1/m²]
  Eigen::VectorXd kept_;            ///< (1 − s) p [Pa]
  Eigen::VectorXd shares_;          ///< s of each
};

}  // namespace palpate::deformation
