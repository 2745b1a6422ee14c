#include "haptics/haptics_process.h"

#include <spdlog/spdlog.h>

#include "haptics/device.h"
#include "haptics/haptic_renderer.h"
#include "modules/core/units.h"
#include "modules/runtime/module.h"
#include "modules/scene/scene_reader.h"

namespace palpate::haptics {
namespace {

/// A device with the renderer of its force, and the messages that tell of them.
struct RenderedProbe {
  std::unique_ptr<Device> device;
  TopicDevice* driven_from_outside;  ///< the device if it is one, else nullptr
  HapticRenderer renderer;
  ProbeState state;
  HapticForce force;
};

std::vector<RenderedProbe> make_probes(const scene::Scene& scene) {
  std::vector<RenderedProbe> probes;
  std::vector<std::string> warnings;
  for (const auto& described : scene.probes) {
    auto device = make_device(described.device, warnings);
    auto* driven = dynamic_cast<TopicDevice*>(device.get());
    probes.push_back({std::move(device),
                      driven,
                      HapticRenderer(scene.haptics, 1.0 / scene.rates.haptics),
                      {},
                      {}});
    probes.back().state.probe = probes.back().force.probe =
        static_cast<std::uint32_t>(probes.size() - 1);
  }
  for (const auto& warning : warnings) spdlog::warn("{}", warning);
  return probes;
}

/// One tick. The force follows the wall clock, not the session's: models age while it is paused.
void tick(const runtime::Module& module, RenderedProbe& probe) {
  const DeviceSample sample = probe.device->read(module.time());
  probe.state.header = probe.force.header = module.header();
  probe.state.pose = sample.pose;
  probe.state.twist = sample.twist;
  probe.state.buttons = sample.buttons;
  probe.renderer.tick(seconds_from_ns(module.now_ns()), sample, probe.force);
}

const char* acting_guard(std::uint32_t limits) {
  if (limits & kForceNotFinite) return "a force or pose was not finite: rendered as zero";
  if (limits & kForceStaleFade)
    return "contact model older than stale_after_s: force fades to zero";
  return "";
}

}  // namespace

runtime::ModuleProgram haptics_program() {
  return {"haptics", "Reads the devices of a scene's probes and renders the force they feel.", {}};
}

void run_haptics(const runtime::ModuleOptions& options) {
  const scene::Scene scene = scene::load_scene(options.scene);
  auto probes = make_probes(scene);
  runtime::Module module(options, scene, "haptics", scene.rates.haptics,
                         runtime::Priority::kRealtime);
  auto inputs = module.bus().reader(bus::kProbeInput);
  auto models = module.bus().reader(bus::kContactModel);
  auto states = module.bus().writer(bus::kProbeState);
  auto forces = module.bus().writer(bus::kHapticForce);
  module.watch(bus::kProbeInput, inputs);
  module.watch(bus::kContactModel, models);
  module.ready();

  ProbeState input;
  ContactModel model;
  while (module.next_cycle()) {
    // newest of what others say; probes the scene does not have are nobody's
    while (inputs.take(input)) {
      if (input.probe >= probes.size() || !probes[input.probe].driven_from_outside) continue;
      probes[input.probe].driven_from_outside->command(input, module.time());
    }
    while (models.take(model)) {
      if (model.probe >= probes.size()) continue;
      probes[model.probe].renderer.update_model(model,
                                                seconds_from_ns(model.header.source_time_ns));
    }
    // one tick of every probe
    const bool reset = module.take_reset();
    std::uint32_t limits = kForceNotLimited;
    for (auto& probe : probes) {
      if (reset) probe.renderer.reset();
      tick(module, probe);
      states.write(probe.state);
      forces.write(probe.force);
      limits |= probe.force.limits;
    }
    module.set_guard(acting_guard(limits));
  }
}

}  // namespace palpate::haptics
