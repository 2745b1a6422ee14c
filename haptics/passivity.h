// Time-domain passivity (Hannaford and Ryu, IEEE Trans. Robot. Autom. 18, 2002): watch the energy
// at the port between device and simulation; where more came out than went in, take it back.
//
// Signs: f is the force on the probe, dx the probe's motion. Pressing gives f·dx < 0, and
//   E += −f·dx + b |dx|²/T     energy put in by the hand, and lost in the device's own damping b.
// dx is the measured motion during which f was held, so the sum is exact for a sampled force.
// E < 0: the simulation generated energy. Then the controller gives f − a v̂ in place of f, with
//   a = −E(after the coming tick)/(T |v|), at most max(0, f·v̂) + α_max |v|:
// it may take away all of the push along the motion, and pay back older debt by at most α_max.
//
// E is kept within [−debt, 2 W], W what the contact could return at most: the energy in a spring of
// its force and stiffness. The rest was lost in tissue or friction and must not pay for a later
// leak. The factor is two because contacts are not linear springs: a Hertz contact holds 1.2 W.
#pragma once

#include "modules/core/types.h"

namespace palpate::haptics {

class Passivity {
 public:
  static constexpr double kMaxAddedDamping = 10;  ///< α_max [N·s/m]; T α_max/2 ≪ any device's mass
  static constexpr double kMaxDebt = 0.01;        ///< [J]; 10 mJ: a 10 mm press at 200 N/m

  /// @param device_damping  b [N·s/m] ≥ 0   @param period  T [s] > 0
  Passivity(double device_damping, double period) : damping_(device_damping), period_(period) {}

  /// The probe has come to `position` while the force given to held() acted.
  /// @param returnable  W of the present contact, before any limit [J] ≥ 0
  void observe(const Vec3& position, double returnable);

  /// The force to command in place of `wanted` with the probe moving at `velocity`.
  /// Equal to `wanted` unless energy was or would be generated.
  Vec3 controlled(const Vec3& wanted, const Vec3& velocity) const;

  /// `force` is what the device is really given from now to the next observe().
  void held(const Vec3& force) { held_force_ = force; }

  /// Contact is over, or the pose is not known: forget energy and position.
  void clear();

  double energy() const { return energy_; }  ///< E [J]

 private:
  double damping_, period_;
  double energy_ = 0;
  bool has_position_ = false;
  Vec3 position_ = Vec3::Zero();
  Vec3 held_force_ = Vec3::Zero();
};

}  // namespace palpate::haptics
