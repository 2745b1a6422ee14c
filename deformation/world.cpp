#include "deformation/world.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "deformation/contact/probe_contacts.h"
#include "deformation/springs/spring_forces.h"
#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

constexpr double kLeastStep = 1e-6;  // [s]
/// The contact model is believed within this part of the mean edge: the touched nodes stay the
/// same.
constexpr double kValidityOfEdge = 0.5;
/// A contact further from its tissue or its probe's origin is none [m]. Searches reach a metre.
constexpr double kFarthestContact = 10;

struct WorldOrgan {
  std::string name;
  SimulatedOrgan simulated;
  IntegratorChoice integrator;
  std::uint32_t generation = 1;
  std::vector<ContactRow> rows;
  double mean_edge = 0;
  bool replaced = false;  ///< its state, at the end of the last advance
};

WorldOrgan make_organ(const scene::Organ& organ, const Vec3& gravity, double period,
                      const geometry::OrganShape& shape, ChunkRunner* runner, Guarding guarding) {
  auto model = std::make_unique<const OrganModel>(build_organ_model(organ, gravity, shape));
  auto dynamics = make_dynamics(organ, *model, period, runner);
  if (dynamics->largest_step() < kLeastStep) {
    std::ostringstream message;
    message << "organ '" << organ.name << "': its largest stable step is "
            << dynamics->largest_step() << " s, less than " << kLeastStep
            << " s; soften the tissue or even out the mesh ('nodes')";
    throw InputError(message.str());
  }
  const IntegratorChoice integrator = choose_integrator(organ, *model, period);
  return {organ.name, SimulatedOrgan(organ, std::move(model), std::move(dynamics), guarding),
          integrator, 1,
          {},         geometry::mean_edge_length(shape.surface)};
}

}  // namespace

struct DeformationWorld::Impl {
  std::vector<WorldOrgan> organs;
  std::vector<ProbeContacts> probes;
  std::vector<Contact> accepted;  ///< buffer of set_contacts()
  double time = 0;
  bool contact_refused = false;  ///< since the last advance

  bool names_our_triangle(const Contact& contact) const {
    return contact.organ < organs.size() &&
           contact.triangle < organs[contact.organ].simulated.model().triangles.size();
  }

  bool is_near(const Contact& contact, const Pose& probe) const {
    const SimulatedOrgan& organ = organs[contact.organ].simulated;
    const auto& nodes = organ.model().triangles[contact.triangle];
    Vec3 tissue = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      tissue += contact.barycentric[k] * organ.state().positions[nodes[k]];
    }
    return contact.point_P.stableNorm() <= kFarthestContact &&
           (probe.to_world(contact.point_P) - tissue).stableNorm() <= kFarthestContact;
  }

  bool believes(const Contact& contact, const Pose& probe) {
    if (!names_our_triangle(contact)) return false;
    const bool near = is_near(contact, probe);
    contact_refused |= !near;
    return near;
  }

  /// One organ through one advance, all probes moving along.
  void advance_organ(std::uint32_t index, double period, AdvanceReport& report) {
    WorldOrgan& organ = organs[index];
    const int substeps = organ.simulated.substeps(period);
    const double h = period / substeps;
    for (int step = 1; step <= substeps; ++step) {
      const double fraction = static_cast<double>(step) / substeps;
      organ.rows.clear();
      const bool aloof = organ.simulated.aloof();
      for (auto& probe : probes) {
        if (aloof) break;
        probe.append_rows(index, organ.simulated.model(), organ.simulated.state(), h, fraction,
                          organ.rows);
      }
      organ.simulated.step(time + fraction * period, h, organ.rows, report);
      std::size_t first = 0;
      for (auto& probe : probes) {
        if (aloof) break;
        first += probe.take_rows(index, fraction, organ.rows.data() + first);
      }
    }
    organ.replaced = !organ.simulated.finish(period, report);
  }

  /// Impulses that a state not believed gave are no force on anybody.
  void drop_contacts(std::uint32_t organ) {
    for (auto& probe : probes) {
      const auto& contacts = probe.contacts();
      const bool near = std::any_of(contacts.begin(), contacts.end(),
                                    [&](const CarriedContact& c) { return c.organ == organ; });
      if (near) probe.reset();
    }
  }

  /// No patch of tissue answers stiffer than its touched nodes with all their neighbours held.
  double stiffness_limit(const ProbeContacts& probe) const {
    double limit = 0;
    for (const CarriedContact& contact : probe.contacts()) {
      if (contact.normal_impulse <= 0) continue;
      const OrganModel& model = organs[contact.organ].simulated.model();
      for (int k = 0; k < 3; ++k) {
        limit +=
            contact.barycentric[k] * model.node_stiffness[model.triangles[contact.triangle][k]];
      }
    }
    return limit;
  }
};

DeformationWorld::DeformationWorld(const scene::Scene& scene,
                                   std::vector<geometry::OrganShape> rest_shapes,
                                   ChunkRunner* runner, Guarding guarding)
    : impl_(std::make_unique<Impl>()) {
  PALPATE_DEMAND(rest_shapes.size() == scene.organs.size());
  for (std::uint32_t i = 0; i < rest_shapes.size(); ++i) {
    impl_->organs.push_back(make_organ(scene.organs[i], scene.gravity, 1 / scene.rates.deformation,
                                       rest_shapes[i], runner, guarding));
  }
  for (const auto& probe : scene.probes) impl_->probes.emplace_back(probe);
}

DeformationWorld::~DeformationWorld() = default;
DeformationWorld::DeformationWorld(DeformationWorld&&) noexcept = default;

std::size_t DeformationWorld::organ_count() const { return impl_->organs.size(); }
std::size_t DeformationWorld::probe_count() const { return impl_->probes.size(); }

const std::string& DeformationWorld::name(std::size_t organ) const {
  return impl_->organs.at(organ).name;
}

const OrganModel& DeformationWorld::model(std::size_t organ) const {
  return impl_->organs.at(organ).simulated.model();
}

std::uint32_t DeformationWorld::generation(std::size_t organ) const {
  return impl_->organs.at(organ).generation;
}

void DeformationWorld::set_probe(std::size_t probe, const Pose& pose) {
  if (probe < impl_->probes.size()) impl_->probes[probe].set_pose(pose);
}

void DeformationWorld::set_contacts(const ContactSet& contacts) {
  if (contacts.probe >= impl_->probes.size()) return;
  std::vector<Contact>& accepted = impl_->accepted;
  accepted.clear();
  for (const Contact& contact : contacts.contacts) {
    if (impl_->believes(contact, contacts.probe_pose)) accepted.push_back(contact);
  }
  impl_->probes[contacts.probe].set_contacts(accepted);
}

AdvanceReport DeformationWorld::advance(double period) {
  AdvanceReport report;
  report.contact_refused = std::exchange(impl_->contact_refused, false);
  for (auto& probe : impl_->probes) report.probe_jumped |= !probe.begin(period);
  for (std::uint32_t i = 0; i < impl_->organs.size(); ++i) {
    impl_->advance_organ(i, period, report);
  }
  for (auto& probe : impl_->probes) probe.end(impl_->stiffness_limit(probe));
  for (std::uint32_t i = 0; i < impl_->organs.size(); ++i) {
    if (impl_->organs[i].replaced) impl_->drop_contacts(i);
  }
  impl_->time += period;
  return report;
}

void DeformationWorld::reset() {
  for (auto& organ : impl_->organs) {
    organ.simulated.reset();
    ++organ.generation;
  }
  for (auto& probe : impl_->probes) probe.reset();
  impl_->time = 0;
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
  const WorldOrgan& organ = impl_->organs.at(organ_index);
  const OrganModel& model = organ.simulated.model();
  const OrganState& state = organ.simulated.state();
  OrganReading reading;
  reading.positions = positions(organ_index);
  reading.volume = geometry::enclosed_volume(state.positions, model.triangles);
  reading.target_volume = std::max(state.target_volume, 0.0);
  reading.pressure = state.pressure;
  reading.kinetic_energy = kinetic_energy(model, state.velocities);
  // A difference of large sums may come out a little below its least value, rest.
  reading.elastic_energy = std::max(0.0, organ.simulated.dynamics().elastic_energy(state));
  return reading;
}

std::span<const Vec3> DeformationWorld::positions(std::size_t organ) const {
  return impl_->organs.at(organ).simulated.state().positions;
}

LocalLaw DeformationWorld::local_law(std::size_t probe_index) const {
  const ProbeContacts& probe = impl_->probes.at(probe_index);
  LocalLaw out;
  probe.response().write(out);
  out.friction_coefficient = probe.friction();
  out.validity_radius = 0;
  for (std::uint32_t i = 0; i < impl_->organs.size(); ++i) {
    if (probe.touches(i)) {
      out.validity_radius =
          std::max(out.validity_radius, kValidityOfEdge * impl_->organs[i].mean_edge);
    }
  }
  return out;
}

}  // namespace palpate::deformation
