// Where a probe's pose comes from, and who feels its force.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "modules/core/state_archive.h"
#include "modules/core/touch.h"
#include "modules/core/types.h"
#include "modules/scene/scene.h"
#include "modules/trajectories/timed_pose.h"

namespace palpate::haptics {

/// One complete sample, by value.
struct DeviceSample {
  Pose pose;    ///< X_WP
  Twist twist;  ///< in W; what moves the pose from one sample to the next
  std::uint32_t buttons = 0;
  std::uint32_t limits = kForceNotLimited;  ///< kPoseSlewed, kPoseRefused
  double silence = 0;                       ///< age of what it tells; infinity: not a word yet [s]
  /// From its pose to the force that answers it, beside the loop's own tick [s]; none: nobody holds
  /// it, its pose is given.
  std::optional<double> delay = std::nullopt;

  void exchange(StateArchive& archive) { archive(pose, twist, buttons, limits, silence, delay); }
};

/// A pose source. All but reset() is called in the haptic loop: no allocation, lock, log or throw.
class Device {
 public:
  virtual ~Device() = default;
  /// Session time stands still while the session is paused, source time never.
  enum class Clock { kSession, kSource };
  virtual Clock clock() const { return Clock::kSession; }  ///< of read()
  /// Pose at `time` [s], which never decreases except after reset().
  virtual DeviceSample read(double time) = 0;
  /// The force commanded to it from now to the next read(): for devices that yield to it.
  virtual void feel(const RenderedForce&) {}
  /// The session begins anew at time 0.
  virtual void reset() {}
  /// All that read() depends on beside its time.
  virtual void exchange(StateArchive&) {}
};

/// A device that another program moves, heard on topic probe_input.
class OutsideDevice : public Device {
 public:
  /// @param said            pose, twist and buttons as they came
  /// @param source_time_ns  the driver's stamp on its own clock; 0 or less: it gives none
  /// @param now_ns          time of hearing, on the clock of source times
  virtual void hear(const DeviceSample& said, std::int64_t source_time_ns, std::int64_t now_ns) = 0;
  /// A sample came that was not even a message.
  virtual void refuse() {}
};

/// Builds the device a probe's scene entry names.
/// @param haptics   when a silent driver's force fades
/// @param warnings  receives a line for each gap or bad row of a recording, at most 20 of either
///                  kind and one line counting them all
/// @throws InputError "file.csv:17: …" if a recording cannot be used
std::unique_ptr<Device> make_device(const scene::Device& device, const scene::Haptics& haptics,
                                    std::vector<std::string>& warnings);

/// The same of a recording that has been read.
/// @param samples  in the recording's frame; at least two, times rising
std::unique_ptr<Device> make_player(const scene::TrajectoryDevice& config,
                                    std::vector<trajectories::TimedPose> samples);

}  // namespace palpate::haptics
