#include "deformation/world.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "deformation/contact_intake.h"
#include "deformation/force_history.h"
#include "deformation/law_of_probe.h"
#include "deformation/organ_contacts.h"
#include "deformation/world_organ.h"
#include "modules/core/error.h"
#include "modules/scene/key_place.h"
#include "modules/scene/models.h"

namespace palpate::deformation {
namespace {

/// A mesh made at the end of an advance is taken in the next and used for some: looked at from
/// their middle, in advances.
constexpr double kLookAhead = 2.5;
/// How often a step is halved so that a probe does not go through the wall.
constexpr int kMostSplits = 5;

}  // namespace

struct DeformationWorld::Impl {
  std::vector<WorldOrgan> organs;
  std::vector<ProbeContacts> probes;
  std::optional<OrganContacts> organ_contacts;  ///< none: the scene has them off
  ContactIntake intake;
  std::vector<Pose> poses;           ///< buffer of look_ahead()
  std::vector<CoreLine> cores;       ///< buffer of change_meshes()
  std::vector<ForceHistory> forces;  ///< on each probe
  double time = 0, period = 0;       ///< simulated; of the last advance [s]

  /// Where probes touch it as a step begins. What comes near may be watched from here on.
  void find_rows(std::uint32_t index, double from, double to) {
    WorldOrgan& organ = organs[index];
    organ.rows.clear();
    if (organ.simulated.contacts_suspended()) return;
    const double h = (to - from) * period;
    for (auto& probe : probes) {
      probe.append_rows(index, *organ.surface, organ.simulated.state(), h, to, organ.rows);
    }
  }

  /// One organ from one fraction of the advance to another, all probes moving along, from the rows
  /// that were found. A probe that would go through the wall is held by more where it does.
  /// @param last_resort  whether the step is taken even if they do not hold it
  /// @returns false if it was not: the organ is as before
  bool step_organ(std::uint32_t index, double from, double to, bool last_resort,
                  AdvanceReport& report) {
    WorldOrgan& organ = organs[index];
    const double h = (to - from) * period;
    SimulatedOrgan::Revise revise;
    if (!organ.simulated.contacts_suspended() && any_may_miss(index)) {
      revise = [&](const OrganState& start, const OrganState& end) {
        return ProbeContacts::hold_missed(probes, index, *organ.surface, start.positions,
                                          end.positions, h, to, organ.rows);
      };
    }
    return organ.simulated.step(time + to * period, h, organ.rows, revise, last_resort, report);
  }

  void take_rows(std::uint32_t index, double from, double to, AdvanceReport& report) {
    WorldOrgan& organ = organs[index];
    if (organ.simulated.contacts_suspended()) return;
    for (auto& probe : probes) probe.take_rows(index, (to - from) * period, organ.rows);
    organ.simulated.move_nodes([&](std::span<Vec3> nodes) {
      report.contacts_unsolved +=
          ProbeContacts::put_back_outside(probes, index, *organ.surface, nodes, to);
    });
  }

  /// The same; where rows do not hold a probe, in halves.
  void step_apart(std::uint32_t index, double from, double to, int splits, AdvanceReport& report) {
    find_rows(index, from, to);
    if (step_organ(index, from, to, splits == 0, report)) {
      return take_rows(index, from, to, report);
    }
    const double middle = (from + to) / 2;
    step_apart(index, from, middle, splits - 1, report);
    step_apart(index, middle, to, splits - 1, report);
  }

  /// Organs that do not touch each other, each in its own steps.
  void advance_apart(AdvanceReport& report) {
    for (std::uint32_t i = 0; i < organs.size(); ++i) {
      const double substeps = organs[i].simulated.substeps(period);
      for (int step = 1; step <= substeps; ++step) {
        step_apart(i, (step - 1) / substeps, step / substeps, kMostSplits, report);
      }
    }
  }

  bool any_may_miss(std::uint32_t organ) const {
    return std::ranges::any_of(probes,
                               [&](const ProbeContacts& probe) { return probe.may_miss(organ); });
  }

  /// What organs do to each other may take one through a probe, or into it, that its own step had
  /// held.
  Missed missed_together(double h, double to) {
    Missed missed = Missed::kNothing;
    for (std::uint32_t i = 0; i < organs.size(); ++i) {
      WorldOrgan& organ = organs[i];
      if (organ.simulated.contacts_suspended()) continue;
      missed = std::max(
          missed, ProbeContacts::hold_missed(probes, i, *organ.surface, organ.start.state.positions,
                                             organ.simulated.state().positions, h, to, organ.rows));
    }
    return missed;
  }

  /// All organs from one fraction of the advance to another, then their contacts with each other.
  /// @returns false if a probe was not held: the organs are as before, but not as a last resort
  bool try_together(double from, double to, bool last_resort, AdvanceReport& report) {
    bool may_miss = false;
    for (std::uint32_t i = 0; i < organs.size(); ++i) {
      find_rows(i, from, to);
      may_miss |= any_may_miss(i);
    }
    if (may_miss) {
      for (WorldOrgan& organ : organs) organ.simulated.keep(organ.start);
    }
    organ_contacts->begin_step();
    const double h = (to - from) * period;
    AdvanceReport tried = report;
    std::vector<std::span<ContactRow>> rows;
    bool held = true;
    for (std::uint32_t i = 0; i < organs.size() && held; ++i) {
      held = step_organ(i, from, to, last_resort, tried);
      rows.emplace_back(organs[i].rows);
    }
    if (held) organ_contacts->end_step(h, rows, tried);
    const Missed missed = held && may_miss ? missed_together(h, to) : Missed::kNothing;
    held &= last_resort || missed != Missed::kCrossing;
    tried.contacts_unsolved += missed != Missed::kNothing;
    if (!held) {
      for (WorldOrgan& organ : organs) organ.simulated.go_back(organ.start);
      return false;
    }
    report = tried;
    return true;
  }

  /// The same; where rows do not hold a probe, in halves.
  void step_together(double from, double to, int splits, AdvanceReport& report) {
    if (try_together(from, to, splits == 0, report)) {
      for (std::uint32_t i = 0; i < organs.size(); ++i) take_rows(i, from, to, report);
      return;
    }
    const double middle = (from + to) / 2;
    step_together(from, middle, splits - 1, report);
    step_together(middle, to, splits - 1, report);
  }

  /// Organs that may touch each other or themselves, all in the same steps.
  void advance_together(AdvanceReport& report) {
    int substeps = 1;
    for (const auto& organ : organs)
      substeps = std::max(substeps, organ.simulated.substeps(period));
    for (int step = 1; step <= substeps; ++step) {
      step_together((step - 1.0) / substeps, static_cast<double>(step) / substeps, kMostSplits,
                    report);
    }
  }

  /// Organs that follow go on with what was made for them; contacts stay where they are on them,
  /// and cores that were outside a wall stay so: where nodes go, the flat triangles in their place
  /// may lie beyond a tip.
  void change_meshes(AdvanceReport& report) {
    for (std::uint32_t i = 0; i < organs.size(); ++i) {
      WorldOrgan& organ = organs[i];
      if (!organ.following) continue;
      if (organ.following->next() != nullptr) {
        cores.clear();
        for (auto& probe : probes) {
          probe.begin_change(i, *organ.surface, organ.simulated.state().positions, cores);
        }
        organ.change_mesh(cores);
        for (auto& probe : probes) {
          report.contacts_unsolved +=
              probe.change_surface(i, organ.following->last_transfer(), *organ.surface,
                                   organ.simulated.state().positions);
        }
      }
      report.mesh_coarser |= organ.is_coarser;
    }
  }

  /// Makes meshes for where the probes will be when they are taken.
  void look_ahead() {
    poses.clear();
    for (const auto& probe : probes) poses.push_back(probe.ahead(kLookAhead));
    for (WorldOrgan& organ : organs) {
      if (!organ.following) continue;
      organ.following->look(poses, organ.simulated.model(), organ.simulated.state().positions,
                            organ.generation + 1);
    }
  }

  /// Judges all organs at the end of an advance. One that was put elsewhere may cross another.
  void finish(AdvanceReport& report) {
    bool any_replaced = false;
    for (WorldOrgan& organ : organs) {
      organ.replaced = !organ.simulated.finish(period, report);
      any_replaced |= organ.replaced;
    }
    if (!organ_contacts || !any_replaced) return;
    organ_contacts->reset();
    if (!organ_contacts->are_crossed()) return;
    report.back_to_rest = true;
    for (WorldOrgan& organ : organs) {
      organ.simulated.put(rest_state(organ.simulated.model()));
      organ.replaced = true;
    }
  }
};

DeformationWorld::DeformationWorld(const scene::Scene& scene,
                                   std::vector<geometry::OrganShape> rest_shapes,
                                   ChunkRunner* runner, Guarding guarding,
                                   const std::vector<geometry::TriangleSurface>& probe_meshes)
    : impl_(std::make_unique<Impl>()) {
  PALPATE_DEMAND(rest_shapes.size() == scene.organs.size());
  for (std::uint32_t i = 0; i < rest_shapes.size(); ++i) {
    impl_->organs.push_back(scene::with_organ(scene, i, [&](const scene::Organ&) {
      return make_organ(scene, i, rest_shapes[i], runner, guarding);
    }));
  }
  if (scene.contacts.any()) {
    std::vector<SimulatedOrgan*> simulated;
    for (WorldOrgan& organ : impl_->organs) simulated.push_back(&organ.simulated);
    impl_->organ_contacts.emplace(scene, std::move(simulated));
  }
  PALPATE_DEMAND(probe_meshes.empty() || probe_meshes.size() == scene.probes.size());
  const geometry::TriangleSurface none{};
  for (std::size_t i = 0; i < scene.probes.size(); ++i) {
    impl_->probes.emplace_back(scene.probes[i], probe_meshes.empty() ? none : probe_meshes[i]);
  }
  impl_->forces.resize(impl_->probes.size());
}

DeformationWorld::~DeformationWorld() = default;
DeformationWorld::DeformationWorld(DeformationWorld&&) noexcept = default;

std::size_t DeformationWorld::organ_count() const { return impl_->organs.size(); }
std::size_t DeformationWorld::probe_count() const { return impl_->probes.size(); }
bool DeformationWorld::holds_on(std::size_t probe, double within) const {
  return impl_->probes.at(probe).holds_on(within);
}

const std::string& DeformationWorld::name(std::size_t organ) const {
  return impl_->organs.at(organ).name;
}

const OrganModel& DeformationWorld::model(std::size_t organ) const {
  return impl_->organs.at(organ).simulated.model();
}

std::uint32_t DeformationWorld::generation(std::size_t organ) const {
  return impl_->organs.at(organ).generation;
}

void DeformationWorld::set_probe(std::size_t probe, const Pose& pose, double kept_within) {
  if (probe < impl_->probes.size()) impl_->probes[probe].set_pose(pose, kept_within);
}

void DeformationWorld::ask_for_volume(std::size_t organ, double ratio) {
  impl_->organs.at(organ).simulated.ask_for_volume(ratio);
}

const OrganMesh* DeformationWorld::next_mesh(std::size_t organ) const {
  const auto& following = impl_->organs.at(organ).following;
  return following ? following->next() : nullptr;
}

std::span<const TouchedPlace> DeformationWorld::touched_places(std::size_t organ) const {
  const auto& following = impl_->organs.at(organ).following;
  return following ? following->places() : std::span<const TouchedPlace>();
}

void DeformationWorld::set_contacts(const ContactSet& contacts,
                                    std::span<const std::uint32_t> generations) {
  if (contacts.probe >= impl_->probes.size()) return;
  impl_->probes[contacts.probe].set_contacts(
      impl_->intake.take(impl_->organs, contacts, generations));
}

void DeformationWorld::forget_contacts(std::size_t probe) {
  if (probe < impl_->probes.size()) impl_->probes[probe].forget_contacts();
}

void DeformationWorld::take_next_meshes() {
  AdvanceReport report;
  impl_->change_meshes(report);
}

AdvanceReport DeformationWorld::advance(double period) {
  AdvanceReport report;
  report.contact_refused = impl_->intake.take_refused();
  impl_->period = period;
  impl_->change_meshes(report);
  for (auto& probe : impl_->probes) report.probe_jumped |= !probe.begin(period);
  impl_->organ_contacts ? impl_->advance_together(report) : impl_->advance_apart(report);
  impl_->finish(report);
  impl_->look_ahead();
  for (auto& probe : impl_->probes) probe.end();
  for (std::uint32_t i = 0; i < impl_->organs.size(); ++i) {
    // Impulses that a state not believed gave are no force on anybody.
    for (auto& probe : impl_->probes) {
      if (impl_->organs[i].replaced && probe.has_contacts(i)) probe.reset();
    }
    if (impl_->organs[i].copy) impl_->organs[i].copy->note_advance();
  }
  for (std::size_t i = 0; i < impl_->probes.size(); ++i) {
    impl_->forces[i].note(impl_->probes[i].impulse() / period);
  }
  impl_->time += period;
  return report;
}

void DeformationWorld::reset() {
  for (auto& organ : impl_->organs) organ.reset();
  for (auto& probe : impl_->probes) probe.reset();
  impl_->forces.assign(impl_->probes.size(), {});
  if (impl_->organ_contacts) impl_->organ_contacts->reset();
  impl_->time = impl_->period = 0;
}

void DeformationWorld::exchange(StateArchive& archive) {
  archive.same(impl_->organs.size());
  archive.same(impl_->probes.size());
  for (auto& organ : impl_->organs) archive(organ);
  for (auto& probe : impl_->probes) archive(probe);
  if (impl_->organ_contacts) archive(*impl_->organ_contacts);
  archive(impl_->intake, impl_->forces, impl_->time, impl_->period);
  if (impl_->forces.size() != impl_->probes.size())
    throw InputError("its state is of other probes");
}

double DeformationWorld::time() const { return impl_->time; }

double DeformationWorld::stable_step(std::size_t organ) const {
  return impl_->organs.at(organ).simulated.dynamics().largest_step();
}

const IntegratorChoice& DeformationWorld::integrator(std::size_t organ) const {
  return impl_->organs.at(organ).integrator;
}

int DeformationWorld::substeps(std::size_t organ, double period) const {
  return impl_->organs.at(organ).simulated.substeps(period);
}

OrganReading DeformationWorld::read(std::size_t organ_index) const {
  const SimulatedOrgan& organ = impl_->organs.at(organ_index).simulated;
  OrganReading reading;
  reading.positions = positions(organ_index);
  reading.volume = organ.volume();
  reading.target_volume = std::max(organ.state().target_volume, 0.0);
  reading.pressure = organ.state().pressure;
  reading.kinetic_energy = kinetic_energy(organ.model(), organ.state().velocities);
  if (impl_->organ_contacts) reading.organ_contacts = impl_->organ_contacts->count(organ_index);
  return reading;
}

double DeformationWorld::elastic_energy(std::size_t organ) const {
  const SimulatedOrgan& simulated = impl_->organs.at(organ).simulated;
  // A difference of large sums may come out a little below its least value, rest.
  return std::max(0.0, simulated.dynamics().elastic_energy(simulated.state()));
}

std::span<const Vec3> DeformationWorld::positions(std::size_t organ) const {
  return impl_->organs.at(organ).simulated.state().positions;
}

const Vec3& DeformationWorld::force(std::size_t probe) const {
  return impl_->forces.at(probe).newest();
}

double DeformationWorld::estimated_force_error(std::size_t probe) const {
  return force_error_of_probe(impl_->organs, impl_->probes.at(probe));
}

LocalLaw DeformationWorld::local_law(std::size_t probe, bool* bounded) const {
  const ForceHistory& forces = impl_->forces.at(probe);
  LocalLaw law = law_of_probe(impl_->organs, impl_->probes, probe, impl_->period, bounded);
  double yielding = 0;
  for (const LawRow& row : law.rows) yielding -= row.force.dot(row.velocity);
  law.growth = forces.growth(impl_->period, yielding);
  return law;
}

}  // namespace palpate::deformation
