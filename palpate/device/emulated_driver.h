// What a driver of a real device does, with an emulated one (haptics/devices/emulated_device.h) in
// the device's place: each period of its own loop, newest force in, pose and velocity out.
#pragma once

#include <optional>

#include "haptics/devices/emulated_device.h"
#include "modules/bus/bus.h"

namespace palpate::launcher {

class EmulatedDriver {
 public:
  /// The driver's own guard: a force heard longer ago no longer goes to the motors [s].
  static constexpr double kForceHolds = 0.1;

  /// @param probe  index in the scene
  EmulatedDriver(const scene::EmulatedDevice& config, std::uint32_t probe, bus::Bus& bus);

  /// One period of its loop.
  /// @param now_ns  when the period began, on the clock of source times
  /// @param period  which one it is since the hand took the device; none: it has not, the device
  ///                stays where it starts
  /// @param buttons  held meanwhile
  void cycle(std::int64_t now_ns, std::optional<std::int64_t> period, std::uint32_t buttons = 0);

  /// Haptics renders by the poses of this device: a force says so, heard within kForceHolds.
  bool is_felt(std::int64_t now_ns) const;

  const haptics::EmulatedDevice& device() const { return device_; }

 private:
  RenderedForce newest_force(std::int64_t now_ns);
  bool holds(std::int64_t now_ns) const;

  haptics::EmulatedDevice device_;
  std::int64_t transport_ns_;  ///< how old a reading is
  bus::Writer<ProbeState> poses_;
  bus::Reader<HapticForce> forces_;
  ProbeState pose_;
  HapticForce heard_, force_;
  std::int64_t force_heard_ns_ = 0;
};

}  // namespace palpate::launcher
