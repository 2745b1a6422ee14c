// Haptics as a stage: local laws in, probe states and rendered forces out.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "haptics/devices/device.h"
#include "modules/bus/bus.h"
#include "modules/runtime/stage.h"

namespace palpate::haptics {

/// Each cycle: take the newest poses from outside and local laws, then for every probe read its
/// device, render the force, publish both. Laws age by the clock of source times, not by the
/// session's: they do so while it is paused. A cycle allocates, locks and logs nothing.
class HapticsStage : public runtime::Stage {
 public:
  /// @param warnings  receives what make_device() has to say
  /// @throws InputError for a recording that cannot be used
  HapticsStage(const scene::Scene& scene, bus::Bus& bus, std::vector<std::string>& warnings);
  ~HapticsStage() override;
  runtime::Health cycle(const runtime::Cycle& now) override;
  void prepare() override;
  /// Forces go to zero within the slew limit: a driver holds what it heard last.
  bool take_leave(const runtime::Cycle& now) override;
  void exchange(StateArchive& archive) override;

  Device& device(std::size_t probe);
  /// In place of the one that the scene names.
  void set_device(std::size_t probe, std::unique_ptr<Device> device);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::haptics
