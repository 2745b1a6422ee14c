// A probe moved by a script: straight moves with the minimum-jerk profile of Flash and Hogan
// (J. Neurosci. 5, 1985), and waits.
#pragma once

#include <vector>

#include "haptics/devices/device.h"

namespace palpate::haptics {

/// Starts at time 0 in `start`, ends holding the last point; rotation constant. Velocity and
/// acceleration are 0 at both ends of every move; the peak speed is 15/8 of its mean.
class ScriptedDevice final : public Device {
 public:
  explicit ScriptedDevice(const scene::ScriptedDevice& script);
  DeviceSample read(double time) override;

 private:
  struct Move {
    double begin = 0, duration = 0;  ///< [s]
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  };
  std::vector<Move> moves_;
  Vec3 start_;
  Quat rotation_;
};

}  // namespace palpate::haptics
