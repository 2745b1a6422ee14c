#include "bench/bullet/palpate_ball.h"

#include <cmath>

#include "studies/report/measures.h"

namespace palpate::bench {
namespace {

constexpr double kNear = 5e-4;  // [m]: a node this close to a plate may touch within a step

scene::Organ stepped_by(const Method& method, scene::Organ organ) {
  organ.model = method.model;
  organ.integrator = method.integrator;
  organ.volume_corrections = static_cast<std::size_t>(method.corrections);
  return organ;
}

int substeps_of(const deformation::OrganDynamics& dynamics) {
  return std::max(1, static_cast<int>(std::ceil(kStep / dynamics.largest_step())));
}

double farthest_beyond(std::span<const Vec3> nodes, double height) {
  double farthest = 0;
  for (const Vec3& x : nodes) farthest = std::max(farthest, std::abs(x.z()) - height);
  return farthest;
}

/// A plate that a device moves.
scene::Probe plate(int side, const Squeeze& squeeze) {
  scene::Probe probe;
  probe.name = side > 0 ? "upper" : "lower";
  probe.shape = scene::PlaneShape{};
  probe.friction = 0;
  scene::ScriptedDevice device;
  device.start = Vec3(0, 0, side * kBallRadius);
  if (side > 0) device.rotation = Quat(0, 1, 0, 0);
  device.moves = {
      {Vec3(0, 0, side * kBallRadius * (1 - squeeze.compression)), squeeze.closing_steps * kStep}};
  probe.device = device;
  return probe;
}

scene::Scene plates_scene(const Ball& ball, const Squeeze& squeeze) {
  scene::Scene scene;
  scene.organs = {ball.organ};
  scene.probes = {plate(1, squeeze), plate(-1, squeeze)};
  scene.rates.haptics = scene.rates.collision = scene.rates.deformation = 1 / kStep;
  return scene;
}

}  // namespace

PalpateBall::PalpateBall(const Ball& ball, const Method& method)
    : ball_(ball),
      model_(ball.model),
      dynamics_(deformation::make_dynamics(stepped_by(method, ball.organ), model_, kStep)),
      state_(deformation::rest_state(model_)),
      corners_(model_.surface_node_count),
      impulses_(model_.surface_node_count, 0),
      substeps_(method.one_step ? 1 : substeps_of(*dynamics_)) {
  for (const auto& t : model_.triangles) {
    for (std::size_t k = 0; k < 3; ++k) corners_[t[k]] = {t[k], t[(k + 1) % 3], t[(k + 2) % 3]};
  }
}

void PalpateBall::find_contacts(double height, double speed) {
  rows_.clear();
  for (std::uint32_t i = 0; i < corners_.size(); ++i) {
    const double z = state_.positions[i].z();
    const double gap = height - std::abs(z);
    if (gap > kNear) continue;
    deformation::ContactRow row;
    row.nodes = corners_[i];
    row.weights = Vec3::UnitX();
    row.normal = Vec3(0, 0, z > 0 ? 1 : -1);
    row.gap = gap;
    row.probe_velocity = speed * row.normal;
    row.normal_impulse = impulses_[i];
    rows_.push_back(row);
  }
}

void PalpateBall::keep_impulses() {
  std::fill(impulses_.begin(), impulses_.end(), 0);
  for (const auto& row : rows_) impulses_[row.nodes[0]] = row.normal_impulse;
}

void PalpateBall::step(double height) {
  const double h = kStep / substeps_, speed = (height - height_) / kStep;
  for (int k = 0; k < substeps_; ++k) {
    find_contacts(height_ + k * h * speed, speed);
    const double begin = report::processor_time();
    dynamics_->step(h, rows_, state_);
    solver_seconds_ += report::processor_time() - begin;
    keep_impulses();
  }
  height_ = height;
}

double PalpateBall::depth_beyond(double height) const {
  return farthest_beyond(state_.positions, height);
}

double PalpateBall::volume() const {
  return geometry::enclosed_volume(state_.positions, ball_.surface.triangles);
}

PipelineBall::PipelineBall(const Ball& ball, const Squeeze& squeeze)
    : pipeline_(plates_scene(ball, squeeze),
                {{ball.surface}, std::vector<geometry::TriangleSurface>(2)}) {}

void PipelineBall::step(double) { pipeline_.tick(); }

double PipelineBall::volume() const { return pipeline_.node_positions(0).volume; }
std::size_t PipelineBall::contact_count() const {
  return pipeline_.contacts(0).count() + pipeline_.contacts(1).count();
}
std::uint64_t PipelineBall::contacts_left_out() const {
  const ContactTroubles troubles = pipeline_.contact_troubles();
  return troubles.truncated + troubles.lost;
}
double PipelineBall::depth_beyond(double height) const {
  return farthest_beyond(pipeline_.world().positions(0), height);
}
double PipelineBall::pressure() const { return pipeline_.node_positions(0).pressure; }

}  // namespace palpate::bench
