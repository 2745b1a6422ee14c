#include "palpate/device/emulated_driver.h"

#include "modules/core/units.h"

namespace palpate::launcher {

EmulatedDriver::EmulatedDriver(const scene::EmulatedDevice& config, std::uint32_t probe,
                               bus::Bus& bus)
    : device_(config),
      transport_ns_(ns_from_seconds(config.transport_delay)),
      poses_(bus.writer(bus::kProbeInput)),
      forces_(bus.reader(bus::kHapticForce)) {
  pose_.probe = probe;
  pose_.pose = {config.start, config.rotation.normalized()};
}

/// The newest force, as long as somebody says one.
RenderedForce EmulatedDriver::newest_force(std::int64_t now_ns) {
  while (forces_.take(heard_)) {
    if (heard_.probe != pose_.probe) continue;
    force_ = heard_;
    force_heard_ns_ = now_ns;
  }
  return holds(now_ns) ? static_cast<const RenderedForce&>(force_) : RenderedForce{};
}

bool EmulatedDriver::holds(std::int64_t now_ns) const {
  return force_heard_ns_ != 0 && now_ns - force_heard_ns_ <= ns_from_seconds(kForceHolds);
}

bool EmulatedDriver::is_felt(std::int64_t now_ns) const {
  return holds(now_ns) && (force_.limits & kDriverSilent) == 0;
}

void EmulatedDriver::cycle(std::int64_t now_ns, std::optional<std::int64_t> period,
                           std::uint32_t buttons) {
  const RenderedForce force = newest_force(now_ns);
  pose_.header.source_time_ns = now_ns;
  if (period) {
    const haptics::DeviceSample sample =
        device_.read(static_cast<double>(*period) * device_.period());
    device_.feel(force);
    pose_.pose = sample.pose;
    pose_.twist = sample.twist;
    pose_.header.source_time_ns -= transport_ns_;
  }
  pose_.buttons = buttons;
  poses_.write(pose_);
}

}  // namespace palpate::launcher
