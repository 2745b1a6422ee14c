#include "studies/calibration/squeezed_ball.h"

#include <algorithm>
#include <cmath>

#include "deformation/organ_messages.h"
#include "modules/core/error.h"
#include "modules/geometry/primitives.h"
#include "studies/rigs/squeezed_ball.h"

namespace palpate::calibration {
namespace {

constexpr double kPeriod = 4e-3;         // of an advance [s]
constexpr double kPlateSpeed = 20e-3;    // [m/s]
constexpr double kContactMargin = 2e-3;  // rows for nodes nearer than this [m]
/// About critical for the ball's slowest mode, the one the plates excite [1/s].
constexpr double kDrag = 60;
constexpr int kCheckEvery = 25;  // advances, 0.1 s
constexpr int kMaxChecks = 60;

scene::Organ damped(scene::Organ organ) {
  organ.name = "ball";
  organ.tissue.drag = kDrag;
  organ.integrator = scene::Integrator::kSymplecticEuler;
  return organ;
}

}  // namespace

std::size_t node_count(int levels) { return (10u << (2 * levels)) + 2; }

SqueezedBall::SqueezedBall(const BallSetup& setup, int levels)
    : outer_radius_(setup.outer_radius),
      surface_depth_(setup.surface_depth),
      world_(rigs::plate_scene(damped(setup.organ)),
             {geometry::make_ball(setup.outer_radius - setup.surface_depth, levels)}),
      height_(setup.outer_radius - setup.surface_depth) {
  deformation::write_node_positions(world_, 0, nodes_);
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
  deformation::write_node_positions(world_, 0, nodes_);
  height_ = height;
}

/// Gives the plate, now at height_, a contact with every node near it, and the height it goes to.
void SqueezedBall::touch(std::uint32_t plate, int side, double height) {
  world_.set_contacts(rigs::plate_contacts(world_, plate, side * height_, side, kContactMargin));
  world_.set_probe(plate, Pose{Vec3(0, 0, side * height), Quat::Identity()});
}

double SqueezedBall::plate_force(std::uint32_t plate) const {
  const LocalLaw model = world_.local_law(plate);
  return std::abs(model.force.z());
}

double SqueezedBall::mean_equatorial_radius() const {
  return rigs::equatorial_radius(world_.model(0).triangles, [&](std::size_t node) {
    const float* p = &nodes_.positions[3 * node];
    return Vec3(p[0], p[1], p[2]);
  });
}

}  // namespace palpate::calibration
