// The force law of one probe, evaluated every haptic tick.
//
// read device → evaluate the local contact model at the current pose → hand-over from the model
// before → stale fade → passivity → finite check → slew limit → saturation → command. The model
// only proposes; limits are ours. docs/haptic_safety.md says what each stage promises.
#pragma once

#include <cstdint>

#include "haptics/device.h"
#include "haptics/force_limits.h"
#include "haptics/local_contact_model.h"
#include "haptics/passivity.h"
#include "modules/messages/messages.h"
#include "modules/scene/scene.h"

namespace palpate::haptics {

class HapticRenderer {
 public:
  /// A new model's difference to the one before is spread over this time, or over the time since
  /// the one before if that is shorter [s].
  static constexpr double kHandOverTime = 0.004;
  /// A torque is limited to what the limited force gives at this arm [m].
  static constexpr double kTorqueArm = 0.1;

  HapticRenderer(const scene::Haptics& limits, double period);  ///< period of the loop [s]

  /// A newer contact model, received at session time `time` [s]. Not finite, or with a normal that
  /// is not a unit vector or a negative friction or radius: refused and counted; the next tick
  /// reports kForceNotFinite, the model before stays in force until it is stale.
  void update_model(const ContactModel& model, double time);

  /// One tick at session time `time` [s]. Fills force, torque, limits, energy and age of `out`;
  /// header and probe are the caller's. Never allocates, locks, logs or throws.
  void tick(double time, const DeviceSample& device, HapticForce& out);

  void reset();  ///< as after construction

  std::uint64_t refused_models() const { return refused_models_; }  ///< since the last reset

 private:
  struct Received {
    ContactModel model;
    double time = 0;     ///< of reception [s]
    bool valid = false;  ///< there is one
  };
  double age(const Received& received, double time) const;
  Wrench propose(const Vec3& p_W, double time, std::uint32_t& limits);
  Wrench wrench_at(const Vec3& p_W, double time, std::uint32_t& limits) const;
  void begin_hand_over(const Vec3& p_W, double time);
  Vec3 passive_force(const Vec3& wanted, const DeviceSample& device, std::uint32_t& limits);

  scene::Haptics limits_;
  double period_;
  ForceLimiter force_limiter_, torque_limiter_;
  Passivity passivity_;

  Received current_, next_;  ///< `next_` takes over at the coming tick
  int hand_over_ticks_ = 1, hand_over_left_ = 0;
  Wrench hand_over_;  ///< old minus new force where the new model took over
  std::uint64_t refused_models_ = 0;
  bool refused_since_tick_ = false;
};

}  // namespace palpate::haptics
