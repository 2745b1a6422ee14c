#include "studies/calibration/squeezed_ball.h"

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"
#include "modules/geometry/primitives.h"

namespace palpate::calibration {
namespace {

constexpr double kPeriod = 4e-3;         // of an advance [s]
constexpr double kPlateSpeed = 20e-3;    // [m/s]
constexpr double kContactMargin = 2e-3;  // rows for nodes nearer than this [m]
/// About critical for the ball's slowest mode, the one the plates excite [1/s].
constexpr double kDrag = 60;
constexpr int kCheckEvery = 25;  // advances, 0.1 s
constexpr int kMaxChecks = 60;

scene::Scene plate_scene(scene::Organ organ) {
  organ.name = "ball";
  organ.tissue.drag = kDrag;
  organ.integrator = scene::Integrator::kSymplecticEuler;
  scene::Scene scene;
  scene.organs.push_back(organ);
  for (const char* name : {"upper_plate", "lower_plate"}) {
    scene.probes.push_back({name, scene::PlaneShape{}, 0.0, scene::ScriptedDevice{}});
  }
  return scene;
}

}  // namespace

std::size_t node_count(int levels) { return (10u << (2 * levels)) + 2; }

SqueezedBall::SqueezedBall(const BallSetup& setup, int levels)
    : outer_radius_(setup.outer_radius),
      surface_depth_(setup.surface_depth),
      world_(plate_scene(setup.organ),
             {geometry::make_ball(setup.outer_radius - setup.surface_depth, levels)}),
      height_(setup.outer_radius - setup.surface_depth) {
  const SurfaceTopology& topology = world_.topology(0);
  corners_.resize(topology.surface_node_count);
  for (std::uint32_t t = 0; t < topology.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      corners_[topology.triangles[t][static_cast<std::size_t>(k)]] = {t, k};
    }
  }
  world_.write_node_positions(0, nodes_);
  rest_equator_ = mean_equatorial_radius();
}

Equilibrium SqueezedBall::squeeze_to(double compression) {
  const double target = outer_radius_ * (1 - compression) - surface_depth_;
  PALPATE_DEMAND(target > 0 && target <= height_ + 1e-12);
  while (height_ > target) advance_plates_to(std::max(target, height_ - kPlateSpeed * kPeriod));

  Equilibrium rest;
  rest.compression = compression;
  for (int check = 0; check < kMaxChecks && !rest.settled; ++check) {
    for (int i = 0; i < kCheckEvery; ++i) advance_plates_to(target);
    const double upper = plate_force(0), lower = plate_force(1), before = rest.force;
    rest.force = (upper + lower) / 2;
    rest.settled = check > 0 && std::abs(rest.force - before) <= 2e-4 * rest.force &&
                   std::abs(upper - lower) <= 1e-3 * rest.force &&
                   nodes_.kinetic_energy <= 1e-6 * nodes_.elastic_energy;
  }
  rest.pressure = nodes_.pressure;
  const double growth = mean_equatorial_radius() / rest_equator_;
  rest.equatorial_radius = (outer_radius_ - surface_depth_) * growth + surface_depth_;
  return rest;
}

void SqueezedBall::advance_plates_to(double height) {
  touch(0, 1, height);
  touch(1, -1, height);
  world_.advance(kPeriod);
  world_.write_node_positions(0, nodes_);
  height_ = height;
}

/// Gives the plate, now at height_, a contact with every node near it, and the height it goes to.
void SqueezedBall::touch(std::uint32_t plate, double side, double height) {
  Contacts contacts;
  contacts.probe = plate;
  contacts.probe_pose.position = Vec3(0, 0, side * height_);
  for (std::uint32_t node = 0; node < corners_.size(); ++node) {
    const Vec3 p = position(node);
    Contact contact;
    contact.gap = height_ - side * p.z();
    if (contact.gap > kContactMargin) continue;
    contact.triangle = corners_[node].triangle;
    contact.barycentric = Vec3::Unit(corners_[node].index);
    contact.point_on_probe = Vec3(p.x(), p.y(), side * height_);
    contact.normal = Vec3(0, 0, side);
    contacts.contacts.push_back(contact);
  }
  world_.set_contacts(contacts);
  ProbeState state;
  state.probe = plate;
  state.pose.position = Vec3(0, 0, side * height);
  world_.set_probe(state);
}

double SqueezedBall::plate_force(std::uint32_t plate) const {
  ContactModel model;
  world_.write_contact_model(plate, model);
  return std::abs(model.force.z());
}

/// Over all points where mesh edges cross z = 0.
double SqueezedBall::mean_equatorial_radius() const {
  double sum = 0;
  int crossings = 0;
  for (const auto& triangle : world_.topology(0).triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = position(triangle[k]), b = position(triangle[(k + 1) % 3]);
      if ((a.z() < 0) == (b.z() < 0)) continue;
      const Vec3 crossing = a + a.z() / (a.z() - b.z()) * (b - a);
      sum += std::hypot(crossing.x(), crossing.y());
      ++crossings;
    }
  }
  return sum / crossings;
}

Vec3 SqueezedBall::position(std::uint32_t node) const {
  const float* p = &nodes_.positions[3 * static_cast<std::size_t>(node)];
  return Vec3(p[0], p[1], p[2]);
}

}  // namespace palpate::calibration
