// A script or a recording that a person can take over, and give back: it yields to poses from
// outside, followed as a mouse is, and returns as smoothly when they stop.
#pragma once

#include <memory>

#include "haptics/devices/mouse_device.h"

namespace palpate::haptics {

/// Untouched it is the script, to the bit. Taken over at the first believable pose, where it is;
/// the script's time goes on meanwhile. Given back by silence: it moves to where the script is by
/// then.
class YieldingDevice final : public OutsideDevice {
 public:
  /// Silence after which it is given back; whoever holds it says where all the time.
  static constexpr double kGivenBackAfter = 1;  ///< of session time [s]
  /// From this near to the script on it is the script.
  static constexpr double kBackWithin = 2e-5;        ///< [m]
  static constexpr double kTurnedBackWithin = 1e-3;  ///< [rad]

  explicit YieldingDevice(std::unique_ptr<Device> script) : script_(std::move(script)) {}
  void hear(const DeviceSample& said, std::int64_t source_time_ns, std::int64_t now_ns) override;
  DeviceSample read(double time) override;
  void reset() override;

  void exchange(StateArchive& archive) override {
    archive(*script_, led_, follower_, pose_, time_, heard_at_);
  }

 private:
  enum class Led { kByScript, kFromOutside, kBack };
  void return_to(const DeviceSample& script);

  std::unique_ptr<Device> script_;
  Led led_ = Led::kByScript;
  MouseDevice follower_{{}};
  Pose pose_;            ///< of the last read()
  double time_ = 0;      ///< of the last read() [s]
  double heard_at_ = 0;  ///< [s]
};

}  // namespace palpate::haptics
