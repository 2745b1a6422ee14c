// The force law of one probe, evaluated every haptic tick.
//
// read device → evaluate the local law at the current pose → cross-fade from the law before
// → stale fade → presence of the driver → passivity → contact damping → finite check → slew
// limit → saturation → command. The law only proposes; limits are ours.
// docs/haptic_safety.md says what each stage promises.
#pragma once

#include <cstdint>

#include "haptics/devices/device.h"
#include "haptics/force_limits.h"
#include "haptics/local_law.h"
#include "haptics/passivity.h"
#include "modules/core/touch.h"
#include "modules/scene/scene.h"

namespace palpate::haptics {

class HapticRenderer {
 public:
  /// A new law's difference to the one before is spread over its period, at most over this [s].
  static constexpr double kLongestCrossFade = 0.025;
  /// A probe that is near nothing, by its law, is let go within this, debt or not [s].
  static constexpr double kLetGo = 0.025;
  /// Of a held device in contact [N·s/m]. With it 0.1 kg on 0.2 N·s/m loses a swing by exp(−2.5
  /// t/s); a hand that holds it has 3 N·s/m and more.
  static constexpr double kContactDamping = 0.3;
  static constexpr double kMostDamped = 0.5;  ///< of a force, at most: it never pulls
  /// A torque is limited to what the limited force gives at this arm [m].
  static constexpr double kTorqueArm = 0.1;

  HapticRenderer(const scene::Haptics& limits, double period);  ///< period of the loop [s]

  /// A newer local law, made at session time `time` [s]. One that is not is_usable() is refused and
  /// counted; the next tick reports kForceNotFinite, the law before stays in force until it is
  /// stale.
  void update_law(const LocalLaw& law, double time);

  /// One tick at session time `time` [s]. Never allocates, locks, logs or throws.
  void tick(double time, const DeviceSample& device, RenderedForce& out);

  /// Forgets the law; what the hand still feels is let go within the slew limit.
  void reset();

  std::uint64_t refused_laws() const { return refused_laws_; }  ///< since the last reset

 private:
  struct Received {
    LocalLaw law;
    double time = 0;     ///< of reception [s]
    bool valid = false;  ///< there is one
  };
  double age(const Received& received, double time) const;
  double presence(double silence);
  bool is_near_nothing(double time) const;
  double stable_stiffness(const DeviceSample& device) const;
  double softening_of(const LocalLaw& law, const DeviceSample& device) const;
  Wrench propose(const DeviceSample& device, double time, std::uint32_t& limits);
  Wrench wrench_at(const Pose& pose, double time, std::uint32_t& limits);
  void begin_cross_fade(const DeviceSample& device, double time);
  double returnable_energy(const Pose& pose, const Vec3& force);
  Vec3 contact_damping(const Vec3& force, const DeviceSample& device) const;
  Wrench passive(const Wrench& wanted, const DeviceSample& device, std::uint32_t& limits);

  scene::Haptics limits_;
  double period_;
  ForceLimiter force_limiter_, torque_limiter_;
  PassivityControl passivity_;

  Received current_, next_;  ///< `next_` takes over at the coming tick
  double without_rows_ = 0;  ///< since when laws have none, if the current one has none [s]
  LawSolver solver_;         ///< of the current law
  double softening_ = 0;     ///< of a law too stiff for the device [m/N]; 0: not capped
  double presence_ = 1;      ///< of who holds the device: 0 when its driver is silent
  int cross_fade_ticks_ = 1, cross_fade_left_ = 0;
  Wrench cross_fade_;   ///< old minus new wrench where the new law took over
  double pressed_ = 0;  ///< how far the device went against the force since it touched, ≥ 0 [m]
  Vec3 pressed_at_ = Vec3::Zero();  ///< where it was last so
  std::uint64_t refused_laws_ = 0;
  bool refused_since_tick_ = false;
};

}  // namespace palpate::haptics
