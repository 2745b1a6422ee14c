// What the tissue answers to one probe: force, and how it changes as the probe moves.
#pragma once

#include "modules/core/touch.h"

namespace palpate::deformation {

/// Collects one probe's contact impulses over an advance and estimates the tissue's stiffness from
/// the last ones.
///
/// Stiffness. From one advance to the next the probe moves by Δx (along the mean normal, tissue to
/// probe) and the normal force changes by Δf. Least squares over the last millimetre of motion
/// (weights fall by 1/e per kMemory of path, so a probe held still keeps its estimate) gives
/// k_n = −Σ Δx Δf / Σ Δx². It needs no model of the tissue, so every deformation model can use it;
/// a small prior Σ Δx² keeps it at zero until the probe has moved. Tangentially k_t = ⅔ k_n, the
/// ratio 2(1−ν)/(2−ν) of a pressed elastic half-space at ν = ½ (Mindlin 1949).
class ContactResponse {
 public:
  /// Forgets the past and the impulses.
  void reset();

  /// Begins an advance of `period` [s].
  void begin(double period);
  /// One contact's impulse on the probe during a sub-step [N·s], at p_W, probe origin at origin_W.
  void add(const Vec3& impulse, const Vec3& normal, const Vec3& p_W, const Vec3& origin_W);
  /// Ends the advance with the probe's origin at `probe_origin` [m].
  /// @param stiffness_limit  largest stiffness believed [N/m]
  void end(const Vec3& probe_origin, double stiffness_limit);

  /// Everything but friction and validity radius.
  void write(LocalLaw& out) const;

 private:
  double period_ = 0;
  Vec3 impulse_ = Vec3::Zero(), angular_impulse_ = Vec3::Zero(), normal_sum_ = Vec3::Zero();
  bool touching_ = false, touched_before_ = false;
  Vec3 origin_ = Vec3::Zero(), force_ = Vec3::Zero(), torque_ = Vec3::Zero();
  Vec3 normal_ = Vec3::UnitZ();
  double normal_force_ = 0;
  double motion_squared_ = 0, motion_times_force_ = 0;  ///< Σ Δx², Σ Δx Δf, weighted
  double stiffness_ = 0;
};

}  // namespace palpate::deformation
