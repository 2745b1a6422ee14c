// Where a probe's pose comes from.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "modules/core/types.h"
#include "modules/scene/scene.h"

namespace palpate::haptics {

/// One complete sample, by value.
struct DeviceSample {
  Pose pose;    ///< X_WP
  Twist twist;  ///< in W
  std::uint32_t buttons = 0;
};

/// A pose source. read() is called in the haptic loop: no allocation, lock, log or throw.
class Device {
 public:
  virtual ~Device() = default;
  /// Pose at session time `time` [s], which never decreases except after a reset.
  virtual DeviceSample read(double time) = 0;
};

/// Builds the device a probe's scene entry names.
/// @param warnings  receives a line for each gap or bad row of a recording, at most 20 of either
///                  kind and one line counting them all
/// @throws InputError "file.csv:17: …" if a recording cannot be used
std::unique_ptr<Device> make_device(const scene::Device& device,
                                    std::vector<std::string>& warnings);

/// A device fed from outside; follows the newest command smoothly and never faster than it was
/// told to. make_device() returns one for scene::TopicDevice.
class TopicDevice : public Device {
 public:
  static constexpr double kMaxSpeed = 0.5;      ///< [m/s]
  static constexpr double kMaxTurn = 6.3;       ///< [rad/s]
  static constexpr double kLongestStep = 0.01;  ///< of one read(), whatever time has passed [s]
  static constexpr double kRampDelay = 0.02;    ///< how far behind a steady motion it is [s]

  explicit TopicDevice(const scene::TopicDevice& config);
  /// New commanded pose; ignored if it is not believable (is_believable()).
  void command(const Pose& commanded, std::uint32_t buttons);
  DeviceSample read(double time) override;

 private:
  DeviceSample current_;
  Pose target_;
  double last_time_ = 0;
};

}  // namespace palpate::haptics
