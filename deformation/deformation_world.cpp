#include "deformation/deformation_world.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "deformation/organ_dynamics.h"
#include "deformation/probe_contacts.h"
#include "deformation/spring_forces.h"
#include "deformation/spring_kernel.h"
#include "deformation/target_volume.h"
#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

constexpr double kLeastStep = 1e-6;      // [s]
constexpr double kMaxNodeSpeed = 100.0;  // [m/s]; nothing soft moves faster and means it
/// The contact model is believed within this part of the mean edge: the touched nodes stay the
/// same.
constexpr double kValidityOfEdge = 0.5;

struct SimulatedOrgan {
  std::unique_ptr<const OrganModel> model;
  std::unique_ptr<OrganDynamics> dynamics;
  std::unique_ptr<SpringKernel> kernel;  ///< for the energy of what is published
  IntegratorChoice integrator;
  TargetVolume target_volume{{}};
  OrganState state, last_good;
  SurfaceTopology topology;
  std::vector<ContactRow> rows;
  double mean_edge = 0;
};

SurfaceTopology make_topology(const scene::Organ& organ, std::uint32_t index,
                              const OrganModel& model) {
  SurfaceTopology topology;
  topology.organ = index;
  topology.generation = 1;
  topology.name = organ.name;
  topology.surface_node_count = static_cast<std::uint32_t>(model.surface_node_count());
  for (const Vec3& p : model.network.rest_positions) {
    for (int axis = 0; axis < 3; ++axis) {
      topology.rest_positions.push_back(static_cast<float>(p[axis]));
    }
  }
  topology.triangles = model.triangles;
  topology.fixed_nodes = model.fixed_nodes;
  for (std::size_t s = 0; s < model.network.springs.size(); ++s) {
    const Spring& spring = model.network.springs[s];
    topology.springs.push_back({spring.node_a, spring.node_b, model.network.family(s)});
  }
  return topology;
}

double mean_structural_length(const SpringNetwork& network) {
  double sum = 0;
  for (std::size_t s = 0; s < network.structural_count; ++s) sum += network.springs[s].rest_length;
  return sum / static_cast<double>(network.structural_count);
}

bool is_sound(const OrganState& state) {
  return std::isfinite(state.pressure) &&
         std::all_of(state.velocities.begin(), state.velocities.end(), [](const Vec3& v) {
           return v.squaredNorm() <= kMaxNodeSpeed * kMaxNodeSpeed;  // false for NaN
         });
}

SimulatedOrgan make_organ(const scene::Organ& organ, std::uint32_t index, const Vec3& gravity,
                          double period, const geometry::TriangleSurface& surface,
                          ChunkRunner* runner) {
  SimulatedOrgan simulated;
  simulated.model = std::make_unique<const OrganModel>(build_organ_model(organ, gravity, surface));
  const OrganModel& model = *simulated.model;
  simulated.dynamics = make_dynamics(organ, model, period, runner);
  simulated.kernel = std::make_unique<SpringKernel>(model, runner);
  simulated.integrator = choose_integrator(organ, model, period);
  simulated.target_volume = TargetVolume(organ.filling);
  simulated.state = simulated.last_good = rest_state(model);
  simulated.topology = make_topology(organ, index, model);
  simulated.mean_edge = mean_structural_length(model.network);
  if (simulated.dynamics->largest_step() < kLeastStep) {
    std::ostringstream message;
    message << "organ '" << organ.name << "': its largest stable step is "
            << simulated.dynamics->largest_step() << " s, less than " << kLeastStep
            << " s; soften the tissue or even out the mesh ('nodes')";
    throw InputError(message.str());
  }
  return simulated;
}

}  // namespace

struct DeformationWorld::Impl {
  std::vector<SimulatedOrgan> organs;
  std::vector<ProbeContacts> probes;
  Contacts accepted;  ///< buffer of set_contacts()
  double time = 0;

  bool names_our_triangle(const Contact& contact) const {
    return contact.organ < organs.size() &&
           contact.triangle < organs[contact.organ].model->triangles.size();
  }

  /// One organ through one advance, all probes moving along.
  void advance_organ(std::uint32_t index, double period, int substeps, AdvanceReport& report) {
    SimulatedOrgan& organ = organs[index];
    const double h = period / substeps;
    for (int step = 1; step <= substeps; ++step) {
      const double fraction = static_cast<double>(step) / substeps;
      organ.rows.clear();
      for (auto& probe : probes) {
        probe.append_rows(index, *organ.model, organ.state, h, fraction, organ.rows);
      }
      organ.state.target_volume =
          organ.model->rest_volume * organ.target_volume.follow(time + fraction * period, h);
      const StepReport stepped = organ.dynamics->step(h, organ.rows, organ.state);
      report.volume_skipped |= stepped.volume_skipped;
      std::size_t first = 0;
      for (auto& probe : probes)
        first += probe.take_rows(index, fraction, organ.rows.data() + first);
    }
    finish(organ, report);
  }

  /// Keeps a sound state; puts an unsound one back, at rest, to where it last was sound.
  static void finish(SimulatedOrgan& organ, AdvanceReport& report) {
    if (is_sound(organ.state)) {
      organ.state.volume = geometry::enclosed_volume(organ.state.positions, organ.model->triangles);
      organ.last_good = organ.state;
      return;
    }
    report.diverged = true;
    organ.state = organ.last_good;
    std::fill(organ.state.velocities.begin(), organ.state.velocities.end(), Vec3::Zero());
  }

  /// No patch of tissue answers stiffer than its touched nodes with all their neighbours held.
  double stiffness_limit(const ProbeContacts& probe) const {
    double limit = 0;
    for (const CarriedContact& contact : probe.contacts()) {
      if (contact.normal_impulse <= 0) continue;
      const OrganModel& model = *organs[contact.organ].model;
      for (int k = 0; k < 3; ++k) {
        limit += contact.weights[k] * model.node_stiffness[model.triangles[contact.triangle][k]];
      }
    }
    return limit;
  }
};

DeformationWorld::DeformationWorld(const scene::Scene& scene,
                                   std::vector<geometry::TriangleSurface> rest_surfaces,
                                   ChunkRunner* runner)
    : impl_(std::make_unique<Impl>()) {
  PALPATE_DEMAND(rest_surfaces.size() == scene.organs.size());
  for (std::uint32_t i = 0; i < rest_surfaces.size(); ++i) {
    impl_->organs.push_back(make_organ(scene.organs[i], i, scene.gravity,
                                       1 / scene.rates.deformation, rest_surfaces[i], runner));
  }
  for (const auto& probe : scene.probes) impl_->probes.emplace_back(probe);
}

DeformationWorld::~DeformationWorld() = default;
DeformationWorld::DeformationWorld(DeformationWorld&&) noexcept = default;

std::size_t DeformationWorld::organ_count() const { return impl_->organs.size(); }
std::size_t DeformationWorld::probe_count() const { return impl_->probes.size(); }

const SurfaceTopology& DeformationWorld::topology(std::size_t organ) const {
  return impl_->organs.at(organ).topology;
}

void DeformationWorld::set_probe(const ProbeState& probe) {
  if (probe.probe < impl_->probes.size()) impl_->probes[probe.probe].set_pose(probe.pose);
}

void DeformationWorld::set_contacts(const Contacts& contacts) {
  if (contacts.probe >= impl_->probes.size()) return;
  Contacts& accepted = impl_->accepted;
  accepted.probe_pose = contacts.probe_pose;
  accepted.contacts.clear();
  for (const Contact& contact : contacts.contacts) {
    if (impl_->names_our_triangle(contact)) accepted.contacts.push_back(contact);
  }
  impl_->probes[contacts.probe].set_contacts(accepted);
}

AdvanceReport DeformationWorld::advance(double period) {
  AdvanceReport report;
  for (auto& probe : impl_->probes) report.probe_jumped |= !probe.begin(period);
  for (std::uint32_t i = 0; i < impl_->organs.size(); ++i) {
    impl_->advance_organ(i, period, substeps(i, period), report);
  }
  for (auto& probe : impl_->probes) probe.end(impl_->stiffness_limit(probe));
  impl_->time += period;
  return report;
}

void DeformationWorld::reset() {
  for (auto& organ : impl_->organs) {
    organ.state = organ.last_good = rest_state(*organ.model);
    organ.target_volume.reset();
    ++organ.topology.generation;
  }
  for (auto& probe : impl_->probes) probe.reset();
  impl_->time = 0;
}

double DeformationWorld::time() const { return impl_->time; }

double DeformationWorld::stable_step(std::size_t organ) const {
  return impl_->organs.at(organ).dynamics->largest_step();
}

const IntegratorChoice& DeformationWorld::integrator(std::size_t organ) const {
  return impl_->organs.at(organ).integrator;
}

int DeformationWorld::substeps(std::size_t organ, double period) const {
  return std::max(1, static_cast<int>(std::ceil(period / stable_step(organ))));
}

void DeformationWorld::write_node_positions(std::size_t organ_index, NodePositions& out) const {
  const SimulatedOrgan& organ = impl_->organs.at(organ_index);
  out.organ = static_cast<std::uint32_t>(organ_index);
  out.generation = organ.topology.generation;
  out.volume = organ.state.volume;
  out.target_volume = organ.state.target_volume;
  out.pressure = organ.state.pressure;
  out.kinetic_energy = kinetic_energy(*organ.model, organ.state.velocities);
  out.elastic_energy = organ.kernel->elastic_energy(organ.state.positions);
  out.positions.resize(3 * organ.model->node_count());
  for (std::size_t i = 0; i < organ.model->node_count(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      out.positions[3 * i + static_cast<std::size_t>(axis)] =
          static_cast<float>(organ.state.positions[i][axis]);
    }
  }
}

void DeformationWorld::write_contact_model(std::size_t probe_index, ContactModel& out) const {
  const ProbeContacts& probe = impl_->probes.at(probe_index);
  out.probe = static_cast<std::uint32_t>(probe_index);
  probe.response().write(out);
  out.friction_coefficient = probe.friction();
  out.validity_radius = 0;
  for (std::uint32_t i = 0; i < impl_->organs.size(); ++i) {
    if (probe.touches(i)) {
      out.validity_radius =
          std::max(out.validity_radius, kValidityOfEdge * impl_->organs[i].mean_edge);
    }
  }
}

}  // namespace palpate::deformation
