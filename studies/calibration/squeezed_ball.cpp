#include "studies/calibration/squeezed_ball.h"

#include <algorithm>
#include <cmath>

#include "deformation/model/organ_model.h"
#include "modules/core/error.h"
#include "modules/geometry/primitives.h"

namespace palpate::calibration {
namespace {

constexpr double kPeriod = 4e-3;         // between looks at the plates' goal [s]
constexpr double kPlateSpeed = 20e-3;    // [m/s]
constexpr double kContactMargin = 2e-3;  // rows for nodes nearer than this [m]
/// About critical for the ball's slowest mode, the one the plates excite [1/s].
constexpr double kDrag = 60;
constexpr int kCheckEvery = 25;  // periods, 0.1 s
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
      body_(damped(setup.organ),
            geometry::make_ball(setup.outer_radius - setup.surface_depth, levels), kPeriod),
      plates_(body_.model(), setup.outer_radius - setup.surface_depth),
      rest_equator_(mean_equatorial_radius()) {}

Equilibrium SqueezedBall::squeeze_to(double compression) {
  const double target = outer_radius_ * (1 - compression) - surface_depth_;
  PALPATE_DEMAND(target > 0 && target <= plates_.height() + 1e-12);
  while (plates_.height() > target) {
    advance_plates_to(std::max(target, plates_.height() - kPlateSpeed * kPeriod));
  }

  Equilibrium rest;
  rest.compression = compression;
  for (int check = 0; check < kMaxChecks && !rest.settled; ++check) {
    for (int i = 0; i < kCheckEvery; ++i) advance_plates_to(target);
    const double upper = plates_.force(0), lower = plates_.force(1), before = rest.force;
    const double kinetic = deformation::kinetic_energy(body_.model(), body_.state().velocities);
    rest.force = (upper + lower) / 2;
    rest.settled = check > 0 && std::abs(rest.force - before) <= 2e-4 * rest.force &&
                   std::abs(upper - lower) <= 1e-3 * rest.force &&
                   kinetic <= 1e-6 * body_.dynamics().elastic_energy(body_.state());
  }
  rest.pressure = body_.state().pressure;
  const double growth = mean_equatorial_radius() / rest_equator_;
  rest.equatorial_radius = (outer_radius_ - surface_depth_) * growth + surface_depth_;
  return rest;
}

/// Within a period, in stable steps.
void SqueezedBall::advance_plates_to(double height) {
  const double from = plates_.height();
  const int steps = static_cast<int>(std::ceil(kPeriod / body_.dynamics().largest_step()));
  for (int k = 1; k <= steps; ++k) {
    plates_.step(body_.dynamics(), kPeriod / steps, from + k * (height - from) / steps,
                 kContactMargin, body_.state());
  }
}

double SqueezedBall::mean_equatorial_radius() const {
  return rigs::equatorial_radius(body_.model().triangles,
                                 [&](std::size_t node) { return body_.state().positions[node]; });
}

}  // namespace palpate::calibration
