// Time-domain passivity (Hannaford and Ryu, IEEE Trans. Robot. Autom. 18, 2002): watch the energy
// at the port between device and simulation; where more came out than went in, take it back.
//
// Signs: f is the wrench on the probe (force, torque), dx the device's motion (translation,
// rotation). Pressing gives f·dx < 0, and
//   E += −f·dx + b |dx|²/T     energy put in by the hand, and lost in the device's own damping b
// (of translation). dx is the measured motion during which f was held, so the sum is exact for a
// sampled force. E < 0: the simulation generated energy. Then the controller gives f − a v̂ in place
// of f, with v the velocity, rotation counted at the arm kArm, and
//   a = −E(after the coming tick)/(T |v|), at most max(0, f·v̂) min(1, |v|/v₁) + α_max |v|:
// it may take away all of the push along the motion, and pay back older debt by at most α_max.
// Below v₁ it goes with the speed: what takes all of a push from whoever moves at all one way, and
// gives it back the other way, shakes a hand at rest, and generates the energy that it takes.
//
// E is kept within [−debt, W], W what the contact could return at most. The rest was lost in tissue
// or friction and must not pay for a later leak.
//
// A device at rest keeps nothing of what was generated, and tissue that appears around it brings W
// with it: where it rests – most readings equal the one before, none is farther than r from the
// first – and E is less than a way of r takes, E becomes W. In debt it would be damped after each
// encoder's step, which is past, as if it went on, and so be kept from rest: debt would make debt.
// A vibration that is read exactly never rests.
#pragma once

#include "haptics/wrench.h"
#include "modules/core/state_archive.h"
#include "modules/core/types.h"

namespace palpate::haptics {

class PassivityControl {
 public:
  static constexpr double kMaxAddedDamping = 10;  ///< α_max [N·s/m]; T α_max/2 ≪ any device's mass
  static constexpr double kFirmFrom = 0.02;       ///< v₁ [m/s]
  static constexpr double kMaxDebt = 0.01;        ///< [J]; 10 mJ: a 10 mm press at 200 N/m
  static constexpr double kRestWay = 1e-4;   ///< r [m]; 55 µm on three axes at once are 95 µm
  static constexpr double kRestTime = 0.05;  ///< that who stands still takes to rest [s]
  static constexpr double kArm = 0.1;        ///< [m]; a turn of 10° counts as 17 mm

  /// @param device_damping  b [N·s/m] ≥ 0   @param period  T [s] > 0
  PassivityControl(double device_damping, double period)
      : damping_(device_damping), period_(period) {}

  /// The device has come to `pose` while the wrench given to held() acted.
  /// @param returnable  W of the present contact, before any limit [J] ≥ 0
  void observe(const Pose& pose, double returnable);

  /// The wrench to command in place of `wanted` with the device moving with `twist`.
  /// Equal to `wanted` unless energy was or would be generated.
  Wrench controlled(const Wrench& wanted, const Twist& twist) const;

  /// `wrench` is what the device is really given from now to the next observe().
  void held(const Wrench& wrench) { held_ = wrench; }

  /// The device has come to `pose`: does it rest? For ticks without contact; observe() does so.
  void watch(const Pose& pose);

  /// Contact is over, or the pose is not known: forget energy and pose, not whether it rests.
  void clear();

  double energy() const { return energy_; }  ///< E [J]

  void exchange(StateArchive& archive) {
    archive(energy_, has_pose_, pose_, rest_pose_, stillness_, held_);
  }

 private:
  double damping_, period_;
  double energy_ = 0;
  bool has_pose_ = false;
  Pose pose_;
  Pose rest_pose_;        ///< no reading since was farther than r from it
  double stillness_ = 0;  ///< share of readings since equal to the one before, the newest most
  Wrench held_;
};

}  // namespace palpate::haptics
