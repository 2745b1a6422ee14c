#include "studies/certify/loop.h"

#include <algorithm>
#include <limits>

#include "haptics/devices/emulated_device.h"
#include "modules/core/error.h"
#include "studies/rigs/wall_stage.h"

namespace palpate::certify {
namespace {

constexpr double kLeft = 0.2;           // [m]
constexpr double kTimeRounding = 1e-9;  // what sums of periods may be off [s]
constexpr int kAskEvery = 50;           // ticks

}  // namespace

Loop loop_on_organ(const Subject& subject, ContactTroubles* troubles) {
  Loop loop{subject.scene, subject.assets, {}, subject.place};
  loop.options.troubles = troubles;
  return loop;
}

Loop loop_on_wall(const scene::Scene& scene, double stiffness) {
  Loop loop{scene, {}, {}, {}};
  loop.scene.organs.clear();
  loop.scene.probes.resize(1);
  loop.scene.probes[0].shape = scene::SphereShape{};
  loop.scene.probes[0].friction = 0;
  loop.assets.probe_meshes.resize(1);
  loop.options.make = [stiffness](
                          std::string_view module, bus::Bus& bus,
                          const session::MakeStage& usual) -> std::unique_ptr<runtime::Stage> {
    if (module == "collision") return nullptr;
    if (module == "deformation") return std::make_unique<rigs::WallStage>(bus, stiffness, true);
    return usual(bus);
  };
  return loop;
}

std::vector<Tick> run_loop(const Loop& loop, const scene::EmulatedDevice& device, double end,
                           const KeepGoing& keep_going) {
  scene::Scene scene = loop.scene;
  scene.probes.at(0).device = device;
  session::InProcess session(scene, loop.assets, loop.options);
  const auto* body = dynamic_cast<const haptics::EmulatedDevice*>(&session.haptics().device(0));
  PALPATE_DEMAND(body != nullptr);
  std::vector<Tick> ticks;
  Vec3 at = device.start, rendered = Vec3::Zero();
  std::uint64_t heard = 0;
  double work = 0;
  for (int i = 0; session.time() < end - kTimeRounding; ++i) {
    if (i % kAskEvery == 0) keep_going();
    const double time = session.time();
    session.tick();
    const HapticForce& force = session.haptic_force(0);
    if (force.header.sequence == heard) continue;  // another module's instant
    heard = force.header.sequence;
    work += body->motor_force().dot(body->position() - at);
    at = body->position();
    const Vec3 off = at - loop.place.pose.position, &into = loop.place.into;
    ticks.push_back({time, off.dot(into), off, -body->motor_force().dot(into), work,
                     -force.force.dot(into), (force.force - rendered).norm(), force.limits});
    rendered = force.force;
    if (off.norm() > kLeft) break;
  }
  return ticks;
}

double swing(const std::vector<Tick>& ticks, double from, double to) {
  if (ticks.empty() || ticks.back().time < to - 0.01) {
    return std::numeric_limits<double>::infinity();
  }
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Tick& tick : ticks) {
    if (tick.time < from || tick.time >= to) continue;
    least = std::min(least, tick.depth);
    most = std::max(most, tick.depth);
  }
  return most - least;
}

const Tick& largest_step(const std::vector<Tick>& ticks, double from, double to) {
  PALPATE_DEMAND(!ticks.empty());
  const Tick* largest = &ticks.front();
  for (const Tick& tick : ticks) {
    if (tick.time >= from && tick.time < to && tick.step > largest->step) largest = &tick;
  }
  return *largest;
}

const Tick* first_force(const std::vector<Tick>& ticks) {
  const auto found =
      std::find_if(ticks.begin(), ticks.end(), [](const Tick& tick) { return tick.step > 0; });
  return found == ticks.end() ? nullptr : &*found;
}

}  // namespace palpate::certify
