#include "studies/volume_methods/measurements.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "deformation/springs/spring_forces.h"
#include "modules/geometry/primitives.h"
#include "modules/scene/models.h"
#include "palpate/session/in_process.h"
#include "studies/report/measures.h"
#include "studies/rigs/squeezed_ball.h"
#include "studies/rigs/test_body.h"

namespace palpate::volume_methods {
namespace {

using deformation::OrganDynamics;
using deformation::OrganState;
using rigs::kBallRadius;
using rigs::Plates;
using rigs::TestBody;

constexpr double kCompression = 0.3;
constexpr double kStep = 1e-3;  // of the squeezed ball [s]
// Runs of about half a millisecond, shorter than a time slice: on a busy machine, too, most of them
// are undisturbed and the median stands.
constexpr int kCostPairs = 201, kCostSteps = 20;

void use(const Method& method, scene::Organ& organ) {
  organ.model = method.model;
  organ.volume_corrections = method.corrections;
  organ.integrator = scene::Integrator::kSymplecticEuler;  // the same springs for all
}

scene::Organ ball_with(const Method& method) {
  auto organ = rigs::ball_organ();
  use(method, organ);
  organ.tissue.drag = 10;  // settles while it is held
  return organ;
}

TestBody ball_at_rest(const scene::Organ& organ, bool quick) {
  return {organ, geometry::make_ball(kBallRadius, quick ? 2 : 3), kStep};
}

double volume_error(const TestBody& ball) {
  const double volume = geometry::enclosed_volume(ball.state().positions, ball.model().triangles);
  return std::abs(volume / ball.state().target_volume - 1);
}

double largest_speed(const TestBody& ball) {
  double largest = 0;
  for (const Vec3& v : ball.state().velocities) {
    if (!(v.norm() <= largest)) largest = v.norm();  // NaN stays
  }
  return largest;
}

/// One step; the energy [J] at its start. The velocities of symplectic Euler belong to the middle
/// of a step, so those at its start are the mean of before and after.
double step_with_energy(TestBody& ball, double h) {
  const auto before = ball.state().velocities;
  const double potential = elastic_energy(ball.model().network(), ball.state().positions) +
                           ball.dynamics().stored_energy(ball.state());
  ball.dynamics().step(h, {}, ball.state());
  auto mean = before;
  for (std::size_t i = 0; i < mean.size(); ++i)
    mean[i] = (before[i] + ball.state().velocities[i]) / 2;
  return potential + kinetic_energy(ball.model(), mean);
}

bool holds_at(const Method& method, bool quick, double h) {
  constexpr double kClosing = 0.3, kHolding = 0.2;
  TestBody ball = ball_at_rest(ball_with(method), quick);
  Plates plates(ball.model(), kBallRadius);
  const int steps = static_cast<int>((kClosing + kHolding) / h);
  for (int s = 1; s <= steps; ++s) {
    const double height = kBallRadius * (1 - kCompression * rigs::minimum_jerk(s * h / kClosing));
    plates.step(ball.dynamics(), h, height, ball.state());
    if (!(largest_speed(ball) < kMaxSoundSpeed)) return false;
  }
  return true;
}

void set_swinging(TestBody& ball, double speed_over_radius) {
  for (std::size_t i = 0; i < ball.model().node_count(); ++i) {
    const Vec3& p = ball.state().positions[i];
    ball.state().velocities[i] = speed_over_radius * Vec3(p.x(), p.y(), -2 * p.z());
  }
}

/// Wall seconds of one step of a swinging ball.
double seconds_per_step(TestBody& ball) {
  ball.state() = rest_state(ball.model());
  set_swinging(ball, 1);
  const double h = std::min(5e-4, ball.dynamics().largest_step());
  ball.dynamics().step(h, {}, ball.state());
  const auto start = std::chrono::steady_clock::now();
  for (int s = 0; s < kCostSteps; ++s) ball.dynamics().step(h, {}, ball.state());
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return elapsed.count() / kCostSteps;
}

}  // namespace

std::vector<Method> compared_methods() {
  std::vector<Method> methods;
  for (const scene::ModelFormat& format : scene::model_formats()) {
    const std::string word = format.word;
    // What is compared has one pass over the springs in a step.
    if (format.is_solid() || format.iterations > 0 || word == "implicit_volume") continue;
    methods.push_back({word, word, 0});
  }
  methods.push_back({"implicit_volume", "implicit_volume", 0});
  methods.push_back({"implicit_volume+1", "implicit_volume", 1});
  return methods;
}

VolumeErrors squeeze_ball(const Method& method, bool quick) {
  constexpr double kClosing = 1, kHeld = 2.5, kEnd = 3.5, kOpening = 0.5;
  TestBody ball = ball_at_rest(ball_with(method), quick);
  Plates plates(ball.model(), kBallRadius);
  VolumeErrors errors;
  errors.step = std::min(kStep, ball.dynamics().largest_step());
  for (int s = 1; s * errors.step <= kEnd; ++s) {
    const double time = s * errors.step;
    const double share =
        rigs::minimum_jerk(time / kClosing) - rigs::minimum_jerk((time - kHeld) / kOpening);
    plates.step(ball.dynamics(), errors.step, kBallRadius * (1 - kCompression * share),
                ball.state());
    const double error = volume_error(ball);
    errors.diverged |= !(largest_speed(ball) < 100);
    errors.peak = std::max(errors.peak, error);
    if (time <= kHeld) {
      errors.force = plates.force();
      errors.pressure = ball.state().pressure;
      if (time > kHeld - 0.5) errors.held = std::max(errors.held, error);
    }
  }
  return errors;
}

StepLimits step_limits(const Method& method, bool quick) {
  StepLimits limits;
  limits.given = ball_at_rest(ball_with(method), quick).dynamics().largest_step();
  double stable = 1e-4, unstable = kLongestTriedStep;
  if (holds_at(method, quick, unstable)) {
    limits.measured = unstable;
    return limits;
  }
  if (!holds_at(method, quick, stable)) return limits;
  while (unstable / stable > 1.02) {
    const double middle = std::sqrt(stable * unstable);
    (holds_at(method, quick, middle) ? stable : unstable) = middle;
  }
  limits.measured = stable;
  return limits;
}

double energy_drift(const Method& method, bool quick) {
  auto organ = ball_with(method);
  organ.tissue.drag = organ.tissue.damping_ratio = 0;
  if (method.model == "chainmail") return std::numeric_limits<double>::quiet_NaN();
  TestBody ball = ball_at_rest(organ, quick);
  // The ellipsoid mode swings at some 2π·5/s: this speed takes the poles a tenth of the radius.
  set_swinging(ball, 2);
  const int steps = static_cast<int>(kVibrationTime / kVibrationStep), tenth = steps / 10;
  double first = 0, last = 0;
  for (int s = 0; s < steps; ++s) {
    const double energy = step_with_energy(ball, kVibrationStep);
    if (s < tenth) first += energy;
    if (s >= steps - tenth) last += energy;
  }
  return last / first - 1;
}

Cost step_cost(const Method& method, bool quick) {
  TestBody plain = ball_at_rest(ball_with(compared_methods().front()), quick);
  TestBody ball = ball_at_rest(ball_with(method), quick);
  std::vector<double> times, ratios;
  for (int pair = 0; pair < kCostPairs; ++pair) {
    const double alone = seconds_per_step(plain);
    times.push_back(seconds_per_step(ball));
    ratios.push_back(times.back() / alone);
  }
  return {report::median(times), report::median(ratios)};
}

VolumeErrors press_organ(const Method& method, const scene::Scene& scene, double seconds) {
  scene::Scene with = scene;
  use(method, with.organs[0]);
  auto pipeline = session::load_session(with);
  const double period = 1 / scene.rates.deformation;
  VolumeErrors errors;
  errors.step = period / pipeline.world().substeps(0, period);
  for (int cycle = 1; cycle * period <= seconds; ++cycle) {
    pipeline.run_until(cycle * period);
    const NodePositions& nodes = pipeline.node_positions(0);
    errors.held = std::abs(nodes.volume / nodes.target_volume - 1);
    errors.peak = std::max(errors.peak, errors.held);
    errors.force = std::max(errors.force, pipeline.contact_model(0).force().norm());
    errors.diverged |= !std::isfinite(nodes.volume);
  }
  return errors;
}

}  // namespace palpate::volume_methods
