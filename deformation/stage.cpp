#include "deformation/stage.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "deformation/following_organ.h"
#include "deformation/guard_text.h"
#include "deformation/law_of_probe.h"
#include "deformation/organ_messages.h"
#include "deformation/own_organs.h"
#include "deformation/simulated_time.h"
#include "deformation/slow_readings.h"
#include "deformation/usual_age.h"
#include "modules/core/units.h"
#include "modules/messages/message_state.h"
#include "modules/runtime/pause_watch.h"
#include "modules/runtime/silence_watch.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/assets.h"
#include "modules/scene/processes.h"

namespace palpate::deformation {
namespace {

/// A probe that rests: without its poses [s], and how far off it then is [m].
constexpr double kHeldUnheard = 1.0, kWhereItWas = 1e-3;
constexpr double kAnywhere = std::numeric_limits<double>::infinity();
/// What joins late is heard by then: discovery takes half a second [s].
constexpr double kHeardWithin = 1.0;

/// Brings probes and contacts to the world, and takes away what is too old to be true. What holds
/// tissue off a round probe goes on without searches: the steps look around its core themselves;
/// off others while they rest, by the contacts that were found last. Tissue let go meanwhile would
/// be around the probe when searches return, and the hand get a blow. Nor is it let go where poses
/// are missed for kHeldUnheard and the probe then is where it was. Laws have no rows meanwhile.
class ProbeInputs {
 public:
  ProbeInputs(bus::Bus& bus, std::size_t probes, const OwnOrgans& organs, const scene::Scene& scene)
      : organs_(organs),
        states_(bus.reader(bus::kProbeState)),
        contacts_(bus.reader(bus::kContacts)),
        states_heard_(probes, runtime::input_stale_after(scene)),
        held_(probes, std::max(runtime::input_stale_after(scene), kHeldUnheard)),
        contacts_heard_(probes, runtime::input_stale_after(scene)),
        sampled_ns_(probes, 0),
        found_ns_(probes, 0),
        usual_ages_(probes, {runtime::input_stale_after(scene), 1 / scene.rates.collision}) {}

  void bring_poses(DeformationWorld& world) {
    while (states_.take(state_)) {
      const std::int64_t sampled_ns = state_.header.source_time_ns;
      if (state_.probe >= sampled_ns_.size()) continue;
      const bool missed = states_heard_.silent(state_.probe, sampled_ns);
      states_heard_.heard(state_.probe, sampled_ns);
      held_.heard(state_.probe, sampled_ns);
      sampled_ns_[state_.probe] = sampled_ns;
      world.set_probe(state_.probe, state_.pose, missed ? kWhereItWas : kAnywhere);
    }
  }
  void bring_contacts(DeformationWorld& world) {
    while (contacts_.take(newest_)) {
      contacts_heard_.heard(newest_.probe, newest_.header.source_time_ns);
      note_found(newest_.probe, newest_.header.source_time_ns);
      organs_.keep_own(newest_, newest_.generations);
      world.set_contacts(newest_, newest_.generations);
    }
  }
  void drop_stale(std::int64_t now_ns, DeformationWorld& world) {
    brought_ns_ = now_ns;
    for (std::uint32_t probe = 0; probe < world.probe_count(); ++probe) {
      const bool held = !silent(probe, now_ns) ||
                        (!held_.silent(probe, now_ns) && world.holds_on(probe, kWhereItWas));
      if (!held) world.forget_contacts(probe);
    }
  }

  /// Of the newest pose of a probe [s].
  double age(std::size_t probe, std::int64_t now_ns) const {
    return std::max(0.0, seconds_from_ns(now_ns - sampled_ns_[probe]));
  }

  /// What a probe's law is as old as: now; once its contacts are older than they usually get,
  /// these. Who feels the law then counts from the last word of who finds contacts, however late
  /// the cycle comes that takes them away.
  std::int64_t law_ns(std::size_t probe, std::int64_t now_ns) const {
    const double old = seconds_from_ns(now_ns - found_ns_[probe]);
    return old > usual_ages_[probe].limit() ? found_ns_[probe] : now_ns;
  }

  /// Whether a probe's pose or contacts are too old to be true.
  bool silent(std::size_t probe, std::int64_t now_ns) const {
    return states_heard_.silent(probe, now_ns) || contacts_heard_.silent(probe, now_ns);
  }
  bool any_silent(std::int64_t now_ns) const {
    return states_heard_.any_silent(now_ns) || contacts_heard_.any_silent(now_ns);
  }

  void exchange(StateArchive& archive) {
    archive(states_heard_, held_, contacts_heard_, sampled_ns_, found_ns_, brought_ns_);
    for (UsualAge& age : usual_ages_) archive(age);
    const std::size_t probes = usual_ages_.size();
    if (sampled_ns_.size() != probes || found_ns_.size() != probes) {
      throw InputError("its state is of other probes");
    }
  }

 private:
  /// Those before it were as old as they got when they were last brought.
  void note_found(std::size_t probe, std::int64_t source_ns) {
    if (probe >= found_ns_.size() || source_ns <= found_ns_[probe]) return;
    usual_ages_[probe].note(seconds_from_ns(brought_ns_ - found_ns_[probe]),
                            seconds_from_ns(source_ns - found_ns_[probe]));
    found_ns_[probe] = source_ns;
  }

  const OwnOrgans& organs_;
  bus::Reader<ProbeState> states_;
  bus::Reader<Contacts> contacts_;
  runtime::SilenceWatch states_heard_, held_, contacts_heard_;
  // Of each probe:
  std::vector<std::int64_t> sampled_ns_;  ///< its newest pose
  std::vector<std::int64_t> found_ns_;    ///< its newest contacts
  std::vector<UsualAge> usual_ages_;      ///< of its contacts
  std::int64_t brought_ns_ = 0;           ///< by the last bring()
  ProbeState state_;
  Contacts newest_;
};

/// The smallest advance that is a whole sub-step of some organ, at most the period [s].
double least_advance(const DeformationWorld& world, double period) {
  double least = period;
  for (std::size_t i = 0; i < world.organ_count(); ++i) {
    least = std::min(least, world.stable_step(i));
  }
  return least;
}

// Errors of forces and energies change slowly, and cost more than a law and than a volume [s].
constexpr double kForceErrorsEvery = 0.1, kEnergiesEvery = 0.04;

/// What leaves the process.
class Outputs {
 public:
  Outputs(bus::Bus& bus, const OwnOrgans& organs, std::size_t probes, std::size_t process)
      : bus_(bus),
        organs_(organs),
        models_(bus.writer(bus::kContactModel)),
        force_errors_(probes, kForceErrorsEvery),
        elastic_energies_(organs.count(), kEnergiesEvery),
        process_(static_cast<std::uint32_t>(process)) {
    for (std::size_t organ = 0; organ < organs.count(); ++organ) {
      extremes_.push_back({organs.in_scene(organ)});
      surfaces_.push_back(bus.writer(bus::kSurface));
      positions_.push_back(bus.writer(bus::kNodePositions));
    }
  }

  void publish_surfaces(const DeformationWorld& world) {
    blocks_.clear();
    next_blocks_.resize(world.organ_count());
    for (std::size_t organ = 0; organ < world.organ_count(); ++organ) {
      SurfaceTopology surface = surface_message(world, organ);
      blocks_.emplace_back(surface.triangles, surface.triangle_blocks);
      next_blocks_[organ] = {surface.generation, {}};
      tell(organ, surface);
    }
  }

  /// An advance before an organ has it, so that nobody is without when it does.
  void publish_next_surfaces(const DeformationWorld& world) {
    for (std::size_t organ = 0; organ < world.organ_count(); ++organ) {
      if (next_blocks_[organ].generation == world.generation(organ)) take_next_blocks(organ, world);
      const OrganMesh* next = world.next_mesh(organ);
      if (next == nullptr || next->generation == next_blocks_[organ].generation) continue;
      SurfaceTopology surface = surface_message(world, organ, *next);
      next_blocks_[organ] = {next->generation, surface.triangle_blocks};
      tell(organ, surface);
    }
  }

  void publish_positions(double sim_time, const DeformationWorld& world, bool running) {
    ran_ = ran_ || running;
    const Header header{0, ns_from_seconds(sim_time), 0};
    elastic_energies_.look(world.time(), [&](std::size_t o) { return world.elastic_energy(o); });
    for (std::size_t organ = 0; organ < world.organ_count(); ++organ) {
      write_node_positions(world, organ, elastic_energies_.of(organ), node_positions_);
      write_block_boxes(blocks_[organ], node_positions_);
      node_positions_.organ = organs_.in_scene(organ);
      node_positions_.header = header;
      positions_[organ].write(node_positions_);
      note_extremes(node_positions_, ran_, extremes_[organ]);
    }
  }

  /// The hand feels them: they leave before anything larger is made ready.
  /// @returns whether the stiffness of one was bounded
  bool publish_laws(double sim_time, const DeformationWorld& world, const ProbeInputs& inputs,
                    std::int64_t now_ns) {
    const Header header{0, ns_from_seconds(sim_time), 0};
    bool any_bounded = false;
    force_errors_.look(world.time(), [&](std::size_t p) { return world.estimated_force_error(p); });
    for (std::size_t probe = 0; probe < world.probe_count(); ++probe) {
      bool bounded = false;
      ContactModel model = contact_model_message(world, probe, &bounded);
      if (inputs.silent(probe, now_ns)) {
        static_cast<LocalLaw&>(model) = without_rows(model);
        bounded = false;
      }
      any_bounded |= bounded;
      model.process = process_;
      model.header = header;
      // The law's age counts from the cycle's beginning, where its probes were.
      const std::int64_t law_ns = model.rows.empty() ? now_ns : inputs.law_ns(probe, now_ns);
      model.header.source_time_ns = law_ns;
      model.anchor_age = inputs.age(probe, law_ns);
      model.force_error = model.touching() ? force_errors_.of(probe) : 0;
      models_.write(model);
    }
    bus_.flush();
    return any_bounded;
  }

  std::span<const OrganExtremes> extremes() const { return extremes_; }

  /// When it reads, surfaces that are not those told at first are said, too.
  void exchange(StateArchive& archive, const DeformationWorld& world) {
    archive(force_errors_, elastic_energies_);
    if (!archive.reads()) return;
    bool as_told = true;
    for (std::size_t organ = 0; organ < world.organ_count(); ++organ) {
      as_told = as_told && next_blocks_[organ].generation == world.generation(organ);
    }
    if (!as_told) publish_surfaces(world);
    publish_next_surfaces(world);
  }

 private:
  struct NextBlocks {
    std::uint32_t generation = 0;
    std::vector<std::uint32_t> of_triangles;  ///< none: the organ has them
  };
  void tell(std::size_t organ, SurfaceTopology& surface) {
    surface.organ = organs_.in_scene(organ);
    surfaces_[organ].write(surface);
  }
  void take_next_blocks(std::size_t organ, const DeformationWorld& world) {
    const auto of_triangles = std::exchange(next_blocks_[organ].of_triangles, {});
    if (of_triangles.empty()) return;
    blocks_[organ] = geometry::SurfaceBlocks(world.model(organ).triangles, of_triangles);
  }

  bus::Bus& bus_;
  const OwnOrgans& organs_;
  // By organ: what each writer counts does not depend on who else is in its process.
  std::vector<bus::Writer<SurfaceTopology>> surfaces_;
  std::vector<bus::Writer<NodePositions>> positions_;
  bus::Writer<ContactModel> models_;
  SlowReadings force_errors_, elastic_energies_;  ///< by probe, by organ
  std::vector<geometry::SurfaceBlocks> blocks_;   ///< by organ
  std::vector<NextBlocks> next_blocks_;           ///< told last
  NodePositions node_positions_;
  std::vector<OrganExtremes> extremes_;  ///< by organ
  std::uint32_t process_;                ///< this one's number
  bool ran_ = false;
};

}  // namespace

struct DeformationStage::Impl {
  Impl(const scene::Scene& scene, DeformationWorld own, bus::Bus& bus, std::size_t process)
      : organs(scene, process),
        world(std::move(own)),
        inputs(bus, world.probe_count(), organs, scene),
        outputs(bus, organs, world.probe_count(), process),
        period(1 / scene.rates.deformation),
        pauses(period) {
    outputs.publish_surfaces(world);
  }

  void reset() {
    world.reset();
    time = {};
    guards.reset();
    outputs.publish_surfaces(world);
  }

  /// Whether it goes on where another process' organs were, or after it was stopped itself, and has
  /// not heard yet, for at most kHeardWithin, what holds them there.
  bool waits(const runtime::Cycle& now) {
    if (now.goes_on) time = {}, troubles = {};  // its predecessor has told them
    if (pauses.was_stopped(now.now_ns, now.computed_ns) || now.goes_on) {
      waits_until_ns = now.now_ns + ns_from_seconds(kHeardWithin);
    }
    if (now.reset || !inputs.any_silent(now.now_ns)) waits_until_ns = 0;
    return now.now_ns < waits_until_ns;
  }

  runtime::Health advance(const runtime::Cycle& now) {
    time.pass(now.time(), world.time());
    report = world.advance(now.advance);
    report.law_bounded = law_bounded;
    troubles.unsolved += static_cast<std::uint64_t>(report.contacts_unsolved) +
                         (report.organ_contacts_unsolved ? 1 : 0);
    runtime::Health health;
    health.real_time_factor = time.factor(now.time(), world.time(), period);
    health.guard = acting_guard(words.of(guards.note(report, world.time())),
                                health.real_time_factor, inputs.any_silent(now.now_ns));
    return health;
  }

  OwnOrgans organs;
  DeformationWorld world;
  ProbeInputs inputs;
  Outputs outputs;
  double period;
  SimulatedTime time;
  GuardLog guards;
  GuardText words;
  AdvanceReport report;
  bool law_bounded = false;  ///< of the laws last sent
  ContactTroubles troubles;
  runtime::PauseWatch pauses;
  std::int64_t waits_until_ns = 0;  ///< at the latest; 0: it does not
};

DeformationStage::DeformationStage(const scene::Scene& scene,
                                   std::vector<geometry::OrganShape> shapes, bus::Bus& bus,
                                   std::size_t process, ChunkRunner* runner, Guarding guarding,
                                   const std::vector<geometry::TriangleSurface>& probe_meshes)
    : impl_(
          std::make_unique<Impl>(scene,
                                 DeformationWorld(scene::part_of(scene, process), std::move(shapes),
                                                  runner, guarding, probe_meshes),
                                 bus, process)) {}

DeformationStage::~DeformationStage() = default;

void DeformationStage::prepare() { impl_->inputs.bring_poses(impl_->world); }

runtime::Health DeformationStage::cycle(const runtime::Cycle& now) {
  if (now.reset) impl_->reset();
  prepare();
  impl_->inputs.bring_contacts(impl_->world);
  const bool waits = impl_->waits(now), running = now.running && !waits;
  if (!waits) impl_->inputs.drop_stale(now.now_ns, impl_->world);
  runtime::Health health;
  if (running) {
    health = impl_->advance(now);
  } else {
    impl_->world.take_next_meshes();
  }
  if (waits) health.guard = "what touches its organs is not heard of yet: they stand still";
  const double sim_time = impl_->time.on_session_clock(impl_->world.time());
  if (running) {
    impl_->law_bounded =
        impl_->outputs.publish_laws(sim_time, impl_->world, impl_->inputs, now.now_ns);
  }
  impl_->outputs.publish_next_surfaces(impl_->world);
  impl_->outputs.publish_positions(sim_time, impl_->world, now.running);
  health.least_advance = least_advance(impl_->world, impl_->period);
  health.contacts = impl_->troubles;
  health.organs = impl_->outputs.extremes();
  return health;
}

void DeformationStage::exchange(StateArchive& archive) {
  archive(impl_->world, impl_->inputs, impl_->time, impl_->guards, impl_->law_bounded,
          impl_->troubles);
  impl_->outputs.exchange(archive, impl_->world);
}

const DeformationWorld& DeformationStage::world() const { return impl_->world; }
void DeformationStage::ask_for_volume(std::size_t organ, double ratio) {
  impl_->world.ask_for_volume(organ, ratio);
}
const AdvanceReport& DeformationStage::report() const { return impl_->report; }

}  // namespace palpate::deformation
