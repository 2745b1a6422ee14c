#include "deformation/deformation_process.h"

#include <algorithm>
#include <optional>

#include "deformation/guard/guard_log.h"
#include "deformation/world.h"
#include "modules/core/units.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/cycle_budget.h"
#include "modules/runtime/module.h"
#include "modules/runtime/silence_watch.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"

namespace palpate::deformation {
namespace {

DeformationWorld load_world(const scene::Scene& scene, ChunkRunner& runner) {
  std::vector<geometry::OrganShape> shapes;
  for (const auto& organ : scene.organs) shapes.push_back(scene::load_organ(organ));
  return DeformationWorld(scene, std::move(shapes), &runner);
}

/// Brings probes and contacts to the world, and takes away what is too old to be true.
class ProbeInputs {
 public:
  ProbeInputs(runtime::Module& module, std::size_t probes)
      : states_(module.bus().reader(bus::kProbeState)),
        contacts_(module.bus().reader(bus::kContacts)),
        states_heard_(probes, runtime::kInputStaleAfter),
        contacts_heard_(probes, runtime::kInputStaleAfter) {
    module.watch(bus::kProbeState, states_);
    module.watch(bus::kContacts, contacts_);
  }

  void bring(std::int64_t now_ns, DeformationWorld& world) {
    while (states_.take(state_)) {
      states_heard_.heard(state_.probe, state_.header.source_time_ns);
      world.set_probe(state_);
    }
    while (contacts_.take(newest_)) {
      contacts_heard_.heard(newest_.probe, newest_.header.source_time_ns);
      world.set_contacts(newest_);
    }
    for (std::uint32_t probe = 0; probe < world.probe_count(); ++probe) {
      if (!states_heard_.silent(probe, now_ns) && !contacts_heard_.silent(probe, now_ns)) continue;
      none_.probe = probe;
      world.set_contacts(none_);
    }
  }

  bool any_silent(std::int64_t now_ns) const {
    return states_heard_.any_silent(now_ns) || contacts_heard_.any_silent(now_ns);
  }

 private:
  bus::Reader<ProbeState> states_;
  bus::Reader<Contacts> contacts_;
  runtime::SilenceWatch states_heard_, contacts_heard_;
  ProbeState state_;
  Contacts newest_, none_;
};

/// Simulated time on the session's clock: a world that joins late begins at the time it joins.
class SimulatedTime {
 public:
  /// Only the first call counts. @param session_time  [s]
  void begin(double session_time) {
    if (!begin_) begin_ = session_time;
  }
  double on_session_clock(double world_time) const { return begin_.value_or(0) + world_time; }
  /// Simulated per wall second, after an advance in the cycle that woke at `session_time`.
  double factor(double session_time, double world_time, double period) const {
    return world_time / (session_time - begin_.value_or(0) + period);
  }

 private:
  std::optional<double> begin_;
};

/// The smallest advance that is a whole sub-step of some organ [s].
double least_advance(const DeformationWorld& world) {
  double least = world.stable_step(0);
  for (std::size_t i = 1; i < world.organ_count(); ++i) {
    least = std::min(least, world.stable_step(i));
  }
  return least;
}

/// Advances by what the budget allows.
AdvanceReport advance(DeformationWorld& world, runtime::CycleBudget& budget) {
  const double simulated = budget.next();
  const std::int64_t begin_ns = runtime::monotonic_now_ns();
  const AdvanceReport report = world.advance(simulated);
  budget.took(simulated, seconds_from_ns(runtime::monotonic_now_ns() - begin_ns));
  return report;
}

/// What leaves the process every cycle.
class Outputs {
 public:
  explicit Outputs(bus::Bus& bus)
      : surfaces_(bus.writer(bus::kSurface)),
        positions_(bus.writer(bus::kNodePositions)),
        models_(bus.writer(bus::kContactModel)) {}

  void publish_surfaces(const DeformationWorld& world) {
    for (std::size_t organ = 0; organ < world.organ_count(); ++organ) {
      SurfaceTopology surface = world.topology(organ);
      surfaces_.write(surface);
    }
  }

  void publish(double sim_time, const DeformationWorld& world) {
    Header header;
    header.sim_time_ns = ns_from_seconds(sim_time);
    for (std::size_t organ = 0; organ < world.organ_count(); ++organ) {
      world.write_node_positions(organ, node_positions_);
      node_positions_.header = header;
      positions_.write(node_positions_);
    }
    for (std::size_t probe = 0; probe < world.probe_count(); ++probe) {
      world.write_contact_model(probe, model_);
      model_.header = header;
      models_.write(model_);
    }
  }

 private:
  bus::Writer<SurfaceTopology> surfaces_;
  bus::Writer<NodePositions> positions_;
  bus::Writer<ContactModel> models_;
  NodePositions node_positions_;
  ContactModel model_;
};

/// @param of_world  the world's own; comes first
const char* acting_guard(const char* of_world, double real_time_factor, bool silent_input) {
  if (*of_world != '\0') return of_world;
  if (silent_input) return "a probe or its contacts are stale: it touches nothing";
  if (real_time_factor < 0.95) return "slower than real time: see the real-time factor";
  return "";
}

}  // namespace

runtime::ModuleProgram deformation_program() {
  return {"deformation", "Simulates the organs of a scene in real time.", {}};
}

void run_deformation(const runtime::ModuleOptions& options) {
  const scene::Scene scene = scene::load_scene(options.scene);
  // Before the module asks for real-time priority: helpers must not keep others from a core.
  runtime::WorkerTeam team(scene.deformation_threads);
  DeformationWorld world = load_world(scene, team);
  runtime::Module module(options, scene, "deformation", scene.rates.deformation,
                         runtime::Priority::kPreferred);
  ProbeInputs inputs(module, world.probe_count());
  Outputs outputs(module.bus());
  SimulatedTime time;
  GuardLog guards;
  runtime::CycleBudget budget(module.period(), least_advance(world));
  outputs.publish_surfaces(world);
  module.ready();

  while (module.next_cycle()) {
    if (module.take_reset()) {
      world.reset();
      time = {};
      guards.reset();
      outputs.publish_surfaces(world);
    }
    inputs.bring(module.now_ns(), world);
    if (module.running()) {
      time.begin(module.time());
      const AdvanceReport report = advance(world, budget);
      const double factor = time.factor(module.time(), world.time(), module.period());
      module.set_real_time_factor(factor);
      module.set_guard(acting_guard(guards.describe(report, world.time()), factor,
                                    inputs.any_silent(module.now_ns())));
    }
    outputs.publish(time.on_session_clock(world.time()), world);
  }
}

}  // namespace palpate::deformation
