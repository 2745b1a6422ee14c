// The force law of one probe, evaluated every haptic tick.
//
// read device → evaluate the local laws at the current pose → cross-fade from those before
// → stale fade → sum → presence of the driver → passivity → contact damping → finite check → slew
// limit → saturation → command. The law only proposes; limits are ours.
// docs/haptic_safety.md says what each stage promises.
#pragma once

#include <cstdint>
#include <vector>

#include "haptics/devices/device.h"
#include "haptics/force_limits.h"
#include "haptics/held_law.h"
#include "haptics/passivity.h"
#include "haptics/pressed_work.h"
#include "modules/core/state_archive.h"
#include "modules/core/touch.h"
#include "modules/scene/scene.h"

namespace palpate::haptics {

class HapticRenderer {
 public:
  /// Of a held device in contact [N·s/m]. With it 0.1 kg on 0.2 N·s/m loses a swing by exp(−6 t/s);
  /// a hand that holds it has 3 N·s/m and more.
  static constexpr double kContactDamping = 1;
  static constexpr double kMostDamped = 0.3;  ///< of a force, at most
  /// A torque is limited to what the limited force gives at this arm [m].
  static constexpr double kTorqueArm = 0.1;

  /// @param period   of the loop [s]
  /// @param sources  of laws: each tells of its own organs, and their forces add
  HapticRenderer(const scene::Haptics& limits, double period, std::size_t sources = 1);

  /// A newer local law of a source, made at session time `time` [s]. One that is not is_usable() is
  /// refused and counted; the next tick reports kForceNotFinite, the law before stays in force
  /// until it is stale.
  void update_law(const LocalLaw& law, double time, std::size_t source = 0);

  /// One tick at session time `time` [s]. Never allocates, locks, logs or throws.
  void tick(double time, const DeviceSample& device, RenderedForce& out);

  /// Forgets the law; what the hand still feels is let go within the slew limit.
  void reset();

  std::uint64_t refused_laws() const { return refused_laws_; }  ///< since the last reset

  /// All that the next tick depends on.
  void exchange(StateArchive& archive) {
    archive(force_limiter_, torque_limiter_, passivity_);
    for (HeldLaw& law : laws_) archive(law);
    archive(presence_, pressed_, refused_laws_, refused_since_tick_);
  }

 private:
  double presence(double silence);
  bool tells_nothing(double time) const;
  double newest_age(double time) const;
  double stable_stiffness(const DeviceSample& device) const;
  double softening_of(const HeldLaw& law, const DeviceSample& device) const;
  Wrench propose(const DeviceSample& device, double time, std::uint32_t& limits);
  double returnable_energy(const Pose& pose, const Vec3& force);
  Vec3 contact_damping(const Vec3& force, const DeviceSample& device) const;
  Wrench passive(const Wrench& wanted, const Wrench& unfaded, const DeviceSample& device,
                 std::uint32_t& limits);

  scene::Haptics limits_;
  double period_;
  ForceLimiter force_limiter_, torque_limiter_;
  PassivityControl passivity_;

  std::vector<HeldLaw> laws_;  ///< by source
  double presence_ = 1;        ///< of who holds the device: 0 when its driver is silent
  PressedWork pressed_;
  std::uint64_t refused_laws_ = 0;
  bool refused_since_tick_ = false;
};

}  // namespace palpate::haptics
