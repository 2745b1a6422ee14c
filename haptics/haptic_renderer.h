// The force law of one probe, evaluated every haptic tick.
//
// read device → evaluate the local contact model at the current pose → stale fade → passivity →
// slew limit → saturation → finite check → command. The model only proposes; limits are ours.
#pragma once

#include "haptics/device.h"
#include "modules/core/messages.h"
#include "modules/scene/scene.h"

namespace palpate::haptics {

class HapticRenderer {
 public:
  HapticRenderer(const scene::Haptics& limits, double period);  ///< period of the loop [s]

  /// A newer contact model, received at session time `time` [s]. Not finite: refused and counted.
  void update_model(const ContactModel& model, double time);

  /// One tick at session time `time` [s]. Fills force, torque, limits, energy and age of `out`;
  /// header and probe are the caller's. Never allocates, locks, logs or throws.
  void tick(double time, const DeviceSample& device, HapticForce& out);

  void reset();  ///< as after construction

 private:
  // defined by the implementation; see haptic_renderer.cpp
  scene::Haptics limits_;
  double period_;
};

}  // namespace palpate::haptics
