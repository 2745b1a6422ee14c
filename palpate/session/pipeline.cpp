#include "palpate/session/pipeline.h"

#include <string>

#include "collision/contact_margin.h"
#include "modules/core/units.h"
#include "modules/scene/assets.h"

namespace palpate::pipeline {
namespace {

/// The k-th period of a module begins at k/rate; integers keep the schedule exact.
struct Schedule {
  std::int64_t period_ns = 0;
  std::int64_t next_ns = 0;

  bool take(std::int64_t now_ns) {
    if (now_ns < next_ns) return false;
    next_ns += period_ns;
    return true;
  }
};

Schedule every(double rate_hz) { return {ns_from_seconds(1 / rate_hz), 0}; }

/// All of one probe.
struct ProbeLoop {
  std::unique_ptr<haptics::Device> device;
  haptics::HapticRenderer renderer;
  ProbeState state;
  Pose last_searched_pose;  ///< at the last search for contacts
  bool searched = false;
  Contacts contacts;
  ContactModel model;
  HapticForce force;
};

std::vector<collision::ProbeGeometry> probe_geometry(
    const scene::Scene& scene, std::vector<geometry::TriangleSurface> meshes) {
  std::vector<collision::ProbeGeometry> geometry;
  for (std::size_t i = 0; i < scene.probes.size(); ++i) {
    geometry.push_back({scene.probes[i].shape, std::move(meshes[i])});
  }
  return geometry;
}

}  // namespace

struct Pipeline::Impl {
  Impl(const scene::Scene& scene_in, std::vector<geometry::OrganShape> organ_shapes,
       std::vector<geometry::TriangleSurface> probe_meshes)
      : scene(scene_in),
        haptics(every(scene_in.rates.haptics)),
        collision(every(scene_in.rates.collision)),
        deformation(every(scene_in.rates.deformation)),
        finder(triangles_of(organ_shapes), probe_geometry(scene_in, std::move(probe_meshes))),
        world(scene_in, std::move(organ_shapes)) {
    std::vector<std::string> warnings;
    for (std::uint32_t i = 0; i < scene.probes.size(); ++i) {
      probes.push_back({haptics::make_device(scene.probes[i].device, warnings),
                        haptics::HapticRenderer(scene.haptics, 1 / scene.rates.haptics),
                        {},
                        {},
                        false,
                        {},
                        {},
                        {}});
      probes[i].state.probe = probes[i].force.probe = i;
    }
    nodes.resize(world.organ_count());
    publish_nodes();
  }

  void tick_haptics(double time) {
    for (ProbeLoop& probe : probes) {
      const haptics::DeviceSample sample = probe.device->read(time);
      probe.state.header.sim_time_ns = probe.force.header.sim_time_ns = now_ns;
      probe.state.pose = sample.pose;
      probe.state.twist = sample.twist;
      probe.state.buttons = sample.buttons;
      probe.renderer.tick(time, sample, probe.force);
    }
  }

  void find_contacts() {
    for (std::size_t organ = 0; organ < nodes.size(); ++organ) {
      finder.update_organ(organ, positions[organ]);
    }
    for (std::uint32_t i = 0; i < probes.size(); ++i) {
      ProbeLoop& probe = probes[i];
      const Pose& pose = probe.state.pose;
      const collision::ProbeMotion motion{probe.searched ? probe.last_searched_pose : pose, pose};
      finder.find(i, motion,
                  collision::contact_margin(scene.rates, probe.state.twist.linear.norm()),
                  probe.contacts);
      probe.contacts.header.sim_time_ns = now_ns;
      probe.contacts.probe = i;
      probe.last_searched_pose = pose;
      probe.searched = true;
      world.set_contacts(probe.contacts);
    }
  }

  void advance(double time) {
    for (ProbeLoop& probe : probes) world.set_probe(probe.state);
    world.advance(1 / scene.rates.deformation);
    publish_nodes();
    for (std::uint32_t i = 0; i < probes.size(); ++i) {
      world.write_contact_model(i, probes[i].model);
      probes[i].model.header.sim_time_ns = now_ns;
      probes[i].renderer.update_model(probes[i].model, time);
    }
  }

  void publish_nodes() {
    positions.resize(nodes.size());
    for (std::size_t organ = 0; organ < nodes.size(); ++organ) {
      NodePositions& message = nodes[organ];
      world.write_node_positions(organ, message);
      message.header.sim_time_ns = now_ns;
      positions[organ].resize(message.positions.size() / 3);
      for (std::size_t i = 0; i < positions[organ].size(); ++i) {
        positions[organ][i] =
            Eigen::Map<const Eigen::Vector3f>(&message.positions[3 * i]).cast<double>();
      }
    }
  }

  scene::Scene scene;
  Schedule haptics, collision, deformation;
  collision::ContactFinder finder;
  deformation::DeformationWorld world;
  std::vector<ProbeLoop> probes;
  std::vector<NodePositions> nodes;
  std::vector<std::vector<Vec3>> positions;  ///< as collision receives them, from float32
  std::int64_t now_ns = 0;
};

Pipeline::Pipeline(const scene::Scene& scene, std::vector<geometry::OrganShape> organ_shapes,
                   std::vector<geometry::TriangleSurface> probe_meshes)
    : impl_(std::make_unique<Impl>(scene, std::move(organ_shapes), std::move(probe_meshes))) {}

Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;

void Pipeline::tick() {
  const double now = time();
  impl_->haptics.take(impl_->now_ns);
  impl_->tick_haptics(now);
  if (impl_->collision.take(impl_->now_ns)) impl_->find_contacts();
  if (impl_->deformation.take(impl_->now_ns)) impl_->advance(now);
  impl_->now_ns = impl_->haptics.next_ns;
}

void Pipeline::run_until(double until) {
  while (time() < until) tick();
}

double Pipeline::time() const { return seconds_from_ns(impl_->now_ns); }
const deformation::DeformationWorld& Pipeline::world() const { return impl_->world; }
const ProbeState& Pipeline::probe(std::size_t probe) const { return impl_->probes.at(probe).state; }
const Contacts& Pipeline::contacts(std::size_t probe) const {
  return impl_->probes.at(probe).contacts;
}
const ContactModel& Pipeline::contact_model(std::size_t probe) const {
  return impl_->probes.at(probe).model;
}
const HapticForce& Pipeline::haptic_force(std::size_t probe) const {
  return impl_->probes.at(probe).force;
}
const NodePositions& Pipeline::node_positions(std::size_t organ) const {
  return impl_->nodes.at(organ);
}
haptics::Device& Pipeline::device(std::size_t probe) { return *impl_->probes.at(probe).device; }

Pipeline load_pipeline(const scene::Scene& scene) {
  std::vector<geometry::OrganShape> organs;
  std::vector<geometry::TriangleSurface> probes;
  for (const auto& organ : scene.organs) organs.push_back(scene::load_organ(organ));
  for (const auto& probe : scene.probes) probes.push_back(scene::load_probe_mesh(probe));
  return Pipeline(scene, std::move(organs), std::move(probes));
}

}  // namespace palpate::pipeline
