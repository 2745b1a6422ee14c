#include "studies/chart/stage.h"

#include <ctime>

#include <algorithm>
#include <cmath>

#include "collision/contact_margin.h"
#include "deformation/organ_messages.h"
#include "modules/scene/assets.h"

namespace palpate::chart {
namespace {

constexpr double kCheckEvery = 0.1;    // [s]
constexpr double kForceChange = 2e-4;  // of the force
constexpr double kLeastForce = 1e-3;   // [N]; changes are seen as parts of no less
constexpr double kEnergyShare = 1e-6;

std::vector<collision::ProbeGeometry> shapes_of(const scene::Scene& scene) {
  std::vector<collision::ProbeGeometry> shapes;
  for (const auto& probe : scene.probes)
    shapes.push_back({probe.shape, scene::load_probe_mesh(probe)});
  return shapes;
}

}  // namespace

double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Stage::Stage(const scene::Scene& scene, const geometry::OrganShape& shape, std::vector<Pose> poses)
    : rates_(scene.rates),
      period_(1 / scene.rates.deformation),
      finder_({shape.surface.triangles}, shapes_of(scene)),
      world_(scene, {shape}),
      poses_(std::move(poses)) {
  rates_.collision = rates_.deformation;
  deformation::write_node_positions(world_, 0, nodes_);
  for (std::uint32_t i = 0; i < poses_.size(); ++i) {
    world_.set_probe(i, poses_[i]);
  }
}

void Stage::search(std::uint32_t probe, double speed) {
  positions_.resize(node_count());
  for (std::size_t i = 0; i < positions_.size(); ++i) positions_[i] = position(i);
  finder_.update_organ(0, positions_);
  finder_.find(probe, {poses_[probe], poses_[probe]}, collision::contact_margin(rates_, speed),
               kMaxContactsPerProbe, contacts_);
  contacts_.probe = probe;
  contacts_.probe_pose = poses_[probe];
  world_.set_contacts(contacts_);
}

void Stage::advance(const std::vector<Pose>& poses) {
  const double begin = processor_time();
  for (std::uint32_t i = 0; i < poses.size(); ++i) {
    search(i, (poses[i].position - poses_[i].position).norm() / period_);
    world_.set_probe(i, poses[i]);
  }
  const double before = processor_time();
  searching_ += before - begin;
  const auto report = world_.advance(period_);
  busy_ += processor_time() - before;
  diverged_ |= report.diverged;
  poses_ = poses;
  deformation::write_node_positions(world_, 0, nodes_);
  volume_error_ = std::max(volume_error_, std::abs(nodes_.volume / nodes_.target_volume - 1));
}

void Stage::settle(double longest) {
  const std::vector<Pose> poses = poses_;
  const int steps = std::max(1, static_cast<int>(std::lround(kCheckEvery / period_)));
  std::vector<double> last(poses.size(), -1);
  for (double waited = 0; waited < longest; waited += steps * period_) {
    for (int i = 0; i < steps; ++i) advance(poses);
    bool still = nodes_.kinetic_energy <= kEnergyShare * nodes_.elastic_energy;
    for (std::uint32_t i = 0; i < poses.size(); ++i) {
      const double now = force(i).norm();
      still &= std::abs(now - last[i]) <= kForceChange * std::max(now, kLeastForce);
      last[i] = now;
    }
    if (still) return;
  }
}

Vec3 Stage::force(std::uint32_t probe) const {
  const LocalLaw law = world_.local_law(probe);
  return law.touching ? law.force : Vec3::Zero();
}

Vec3 Stage::position(std::size_t node) const {
  return Eigen::Map<const Eigen::Vector3f>(&nodes_.positions[3 * node]).cast<double>();
}

Vec3 Stage::rest_position(std::size_t node) const {
  return world_.model(0).rest_positions[node].cast<float>().cast<double>();
}

}  // namespace palpate::chart
