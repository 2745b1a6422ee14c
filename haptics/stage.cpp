#include "haptics/stage.h"

#include "haptics/haptic_renderer.h"
#include "modules/core/units.h"

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

std::vector<RenderedProbe> make_probes(const scene::Scene& scene,
                                       std::vector<std::string>& warnings) {
  std::vector<RenderedProbe> probes;
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
  return probes;
}

void tick(const runtime::Cycle& now, RenderedProbe& probe) {
  const DeviceSample sample = probe.device->read(now.time());
  probe.state.header = probe.force.header = now.header();
  probe.state.pose = sample.pose;
  probe.state.twist = sample.twist;
  probe.state.buttons = sample.buttons;
  probe.renderer.tick(seconds_from_ns(now.now_ns), sample, probe.force);
}

const char* acting_guard(std::uint32_t limits) {
  if (limits & kForceNotFinite) return "a force or pose was not finite: rendered as zero";
  if (limits & kForceStaleFade)
    return "contact model older than stale_after_s: force fades to zero";
  return "";
}

}  // namespace

struct HapticsStage::Impl {
  Impl(const scene::Scene& scene, bus::Bus& bus, std::vector<std::string>& warnings)
      : probes(make_probes(scene, warnings)),
        inputs(bus.reader(bus::kProbeInput)),
        laws(bus.reader(bus::kContactModel)),
        states(bus.writer(bus::kProbeState)),
        forces(bus.writer(bus::kHapticForce)) {}

  /// Newest of what others say; probes the scene does not have are nobody's.
  void listen() {
    while (inputs.take(input)) {
      if (input.probe >= probes.size() || !probes[input.probe].driven_from_outside) continue;
      probes[input.probe].driven_from_outside->command(input.pose, input.buttons);
    }
    while (laws.take(law)) {
      if (law.probe >= probes.size()) continue;
      probes[law.probe].renderer.update_law(law, seconds_from_ns(law.header.source_time_ns));
    }
  }

  std::vector<RenderedProbe> probes;
  bus::Reader<ProbeState> inputs;
  bus::Reader<ContactModel> laws;
  bus::Writer<ProbeState> states;
  bus::Writer<HapticForce> forces;
  ProbeState input;
  ContactModel law;
};

HapticsStage::HapticsStage(const scene::Scene& scene, bus::Bus& bus,
                           std::vector<std::string>& warnings)
    : impl_(std::make_unique<Impl>(scene, bus, warnings)) {}

HapticsStage::~HapticsStage() = default;

runtime::Health HapticsStage::cycle(const runtime::Cycle& now) {
  impl_->listen();
  std::uint32_t limits = kForceNotLimited;
  for (RenderedProbe& probe : impl_->probes) {
    if (now.reset) probe.renderer.reset();
    tick(now, probe);
    impl_->states.write(probe.state);
    impl_->forces.write(probe.force);
    limits |= probe.force.limits;
  }
  return {.guard = acting_guard(limits)};
}

Device& HapticsStage::device(std::size_t probe) { return *impl_->probes.at(probe).device; }

void HapticsStage::set_device(std::size_t probe, std::unique_ptr<Device> device) {
  RenderedProbe& rendered = impl_->probes.at(probe);
  rendered.driven_from_outside = dynamic_cast<TopicDevice*>(device.get());
  rendered.device = std::move(device);
}

}  // namespace palpate::haptics
