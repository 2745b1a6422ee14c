#include "haptics/stage.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "haptics/devices/driver_watch.h"
#include "haptics/haptic_renderer.h"
#include "modules/core/units.h"
#include "modules/scene/processes.h"

namespace palpate::haptics {
namespace {

/// What a status says of a probe; made ready because a cycle allocates nothing.
struct ProbeTexts {
  explicit ProbeTexts(const std::string& name)
      : several("probe '" + name +
                "': several programs move it on probe_input: it jumps between their poses"),
        silent("probe '" + name + "': its driver is silent on probe_input: no force"),
        unheard("probe '" + name + "': its driver is silent so far: nothing on probe_input"),
        refused("probe '" + name + "': a sample from its driver was refused"),
        slewed("probe '" + name + "': its driver moves too fast: the pose is slewed") {}
  std::string several, silent, unheard, refused, slewed;
};

/// What a probe's force has been since the session first ran. While that stands, whoever waits for
/// news calls it old, and forces fade: no limit that tells of the touch. All others count.
void note_extremes(const HapticForce& said, double force_error, bool runs, bool stands,
                   ProbeExtremes& of) {
  of.force = said.force.norm();
  if (!runs) return;
  if (of.force > of.greatest_force) {
    of.greatest_force = of.force;
    of.error_of_greatest = force_error;
  }
  constexpr std::uint32_t kFadesWhileStanding = kForceStaleFade | kForceSlewLimited;
  of.limits |= said.limits & ~(stands ? kFadesWhileStanding : 0u);
}

/// A device with the renderer of its force, and the messages that tell of them.
struct RenderedProbe {
  std::unique_ptr<Device> device;
  OutsideDevice* outside;  ///< the device if it is one, else nullptr
  DriverWatch drivers;     ///< of `outside`
  bool several_drivers = false;
  HapticRenderer renderer;
  ProbeTexts texts;
  ProbeState state;
  HapticForce force;
  bool is_heard = true;  ///< somebody says where it is

  void set_device(std::unique_ptr<Device> other) {
    device = std::move(other);
    outside = dynamic_cast<OutsideDevice*>(device.get());
  }
};

std::vector<RenderedProbe> make_probes(const scene::Scene& scene,
                                       std::vector<std::string>& warnings) {
  std::vector<RenderedProbe> probes;
  for (const auto& described : scene.probes) {
    probes.push_back(
        {nullptr,
         nullptr,
         {},
         false,
         HapticRenderer(scene.haptics, 1.0 / scene.rates.haptics, scene::process_count(scene)),
         ProbeTexts(described.name),
         {},
         {}});
    probes.back().set_device(make_device(described.device, scene.haptics, warnings));
    probes.back().state.probe = probes.back().force.probe =
        static_cast<std::uint32_t>(probes.size() - 1);
  }
  return probes;
}

/// @returns whether it is known where the probe is: in a session that ran before, a driver that has
/// not said a word yet moved it all the same
bool tick(const runtime::Cycle& now, RenderedProbe& probe) {
  const double source_time = seconds_from_ns(now.now_ns);
  const bool by_source = probe.device->clock() == Device::Clock::kSource;
  const DeviceSample sample = probe.device->read(by_source ? source_time : now.time());
  probe.is_heard = std::isfinite(sample.silence);
  probe.state.header = probe.force.header = now.header();
  probe.renderer.tick(source_time, sample, probe.force);
  probe.device->feel(probe.force);
  probe.state.pose = sample.pose;
  probe.state.twist = sample.twist;
  probe.state.buttons = sample.buttons;
  return !now.joined || probe.is_heard;
}

bool is_zero(const RenderedForce& force) { return force.force.isZero(0) && force.torque.isZero(0); }

const char* acting_guard(const RenderedProbe& probe) {
  const std::uint32_t limits = probe.force.limits;
  if (limits & kForceNotFinite) return "a force or pose was not finite: rendered as zero";
  if (probe.several_drivers) return probe.texts.several.c_str();
  if (limits & kPoseSlewed) return probe.texts.slewed.c_str();
  if (limits & kDriverSilent) {
    return probe.is_heard ? probe.texts.silent.c_str() : probe.texts.unheard.c_str();
  }
  if (limits & kForceStaleFade)
    return "contact model older than stale_after_s: force fades to zero";
  if (limits & kPoseRefused) return probe.texts.refused.c_str();
  return "";
}

}  // namespace

struct HapticsStage::Impl {
  Impl(const scene::Scene& scene, bus::Bus& bus, std::vector<std::string>& warnings)
      : probes(make_probes(scene, warnings)),
        processes(scene::process_count(scene)),
        inputs(bus.reader(bus::kProbeInput, bus::Keep::kBacklog)),
        laws(bus.reader(bus::kContactModel)),
        states(bus.writer(bus::kProbeState)),
        forces(bus.writer(bus::kHapticForce)),
        force_errors(probes.size() * processes, 0),
        extremes(probes.size()) {
    for (std::size_t k = 0; k < probes.size(); ++k) {
      extremes[k].probe = static_cast<std::uint32_t>(k);
    }
  }

  /// Newest of what others say; probes the scene does not have are nobody's.
  void listen(std::int64_t now_ns) {
    while (inputs.take(input)) {
      if (input.probe >= probes.size() || !probes[input.probe].outside) continue;
      const DeviceSample said{input.pose, input.twist, input.buttons};
      probes[input.probe].outside->hear(said, input.header.source_time_ns, now_ns);
      probes[input.probe].drivers.hear(inputs.writer(), now_ns);
    }
    for (RenderedProbe& probe : probes) probe.several_drivers = probe.drivers.several(now_ns);
    note_rejected();
    take_laws();
  }

  void take_laws() {
    while (laws.take(law)) {
      if (law.probe >= probes.size() || law.process == 0 || law.process > processes) continue;
      probes[law.probe].renderer.update_law(law, seconds_from_ns(law.header.source_time_ns),
                                            law.process - 1);
      force_errors[law.probe * processes + law.process - 1] = law.force_error;
    }
  }

  void note_extremes(const runtime::Cycle& now) {
    if (!now.running) stood_ns = now.now_ns;
    ran = ran || now.running;
    const bool stands = stood_ns && now.now_ns - *stood_ns < runtime::kGoesOnWithinNs;
    for (std::size_t k = 0; k < probes.size(); ++k) {
      const auto errors = std::span(force_errors).subspan(k * processes, processes);
      haptics::note_extremes(probes[k].force, std::ranges::max(errors), ran, stands, extremes[k]);
    }
  }

  /// Whose a sample was that is no message, nobody knows: all that are driven from outside say so.
  void note_rejected() {
    if (inputs.statistics().rejected == rejected) return;
    rejected = inputs.statistics().rejected;
    for (RenderedProbe& probe : probes) {
      if (probe.outside) probe.outside->refuse();
    }
  }

  std::vector<RenderedProbe> probes;
  std::size_t processes;           ///< of deformation
  bus::Reader<ProbeState> inputs;  ///< all: of several drivers the newest hides the others'
  bus::Reader<ContactModel> laws;
  bus::Writer<ProbeState> states;
  bus::Writer<HapticForce> forces;
  ProbeState input;
  ContactModel law;
  std::vector<double> force_errors;  ///< of the newest law, by probe and then process
  std::vector<ProbeExtremes> extremes;
  bool ran = false;                      ///< the session has
  bool leaves = false;                   ///< takes leave
  std::optional<std::int64_t> stood_ns;  ///< when it last did not run
  std::uint64_t rejected = 0;            ///< of `inputs`, as far as it was noted
};

HapticsStage::HapticsStage(const scene::Scene& scene, bus::Bus& bus,
                           std::vector<std::string>& warnings)
    : impl_(std::make_unique<Impl>(scene, bus, warnings)) {}

HapticsStage::~HapticsStage() = default;

void HapticsStage::prepare() { impl_->take_laws(); }

runtime::Health HapticsStage::cycle(const runtime::Cycle& now) {
  impl_->listen(now.now_ns);
  runtime::Health health;
  for (RenderedProbe& probe : impl_->probes) {
    if (now.reset) {
      probe.renderer.reset();
      probe.device->reset();
    }
    if (tick(now, probe)) impl_->states.write(probe.state);
    impl_->forces.write(probe.force);
    if (*health.guard == '\0') health.guard = acting_guard(probe);
  }
  impl_->note_extremes(now);
  health.probes = impl_->extremes;
  return health;
}

bool HapticsStage::take_leave(const runtime::Cycle& now) {
  bool is_done = true;
  for (RenderedProbe& probe : impl_->probes) {
    if (!impl_->leaves) probe.renderer.reset();
    is_done = is_done && impl_->leaves && is_zero(probe.force);
    tick(now, probe);
    impl_->forces.write(probe.force);
  }
  impl_->leaves = true;
  return is_done;
}

void HapticsStage::exchange(StateArchive& archive) {
  archive.same(impl_->probes.size());
  for (RenderedProbe& probe : impl_->probes) archive(*probe.device, probe.renderer);
}

Device& HapticsStage::device(std::size_t probe) { return *impl_->probes.at(probe).device; }

void HapticsStage::set_device(std::size_t probe, std::unique_ptr<Device> device) {
  impl_->probes.at(probe).set_device(std::move(device));
}

}  // namespace palpate::haptics
