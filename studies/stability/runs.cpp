#include "studies/stability/runs.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "deformation/guard/divergence_detector.h"
#include "deformation/springs/spring_forces.h"
#include "modules/core/polar_decomposition.h"

namespace palpate::stability {
namespace {

using deformation::OrganModel;

constexpr double kSwing = 1e-3, kStir = 1e-3;  // of the radius, of the swing
constexpr double kEnergyDrift = 0.1, kVolumeDrift = 0.01;
constexpr double kDampingRatio = 0.1, kDrag = 10;  // [1], [1/s]
constexpr double kNear = 5e-3;                     // a node this close may touch [m]
constexpr double kClosing = 0.3, kHolding = 0.2;   // [s]
constexpr double kHonestSpeed = 1;                 // of tissue beside that of what moves it [m/s]
constexpr double kSphere = 0.02, kDepth = 0.02;    // [m]

double random_share(std::mt19937& random) { return random() / double(random.max()) - 0.5; }

/// The rotation that fits the surface's rest positions to `x` best (Kabsch); none if x is no
/// number.
Mat3 best_rotation(const OrganModel& model, const std::vector<Vec3>& x) {
  const auto& rest = model.rest_positions;
  const std::size_t count = model.surface_node_count;
  Vec3 rest_mean = Vec3::Zero(), mean = Vec3::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    rest_mean += rest[i] / static_cast<double>(count);
    mean += x[i] / static_cast<double>(count);
  }
  Mat3 covariance = Mat3::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    covariance += (x[i] - mean) * (rest[i] - rest_mean).transpose();
  }
  if (!covariance.allFinite()) return Mat3::Identity();
  return nearest_rotation(covariance);
}

Tolerance driven(const Scheme& scheme, const TestBody& body, double speed) {
  const double fastest = speed + kHonestSpeed;
  return {0.5 * body.mass() * fastest * fastest, kAnything,
          scheme.keeps_volume ? kVolumeDrift : kAnything};
}

/// How a free ball's motion is judged.
struct Swing {
  Tolerance tolerance;
  Energy energy = Energy::kMidway;
};

/// Sets the body swinging.
Swing swing_of(const Scheme& scheme, double youngs_modulus, TestBody& body) {
  // The ellipsoid mode of this ball swings at about 30 rad/s at 10 kPa; solid ones a little faster.
  const double frequency = 30 * std::sqrt(youngs_modulus / 10e3);
  std::mt19937 random(1);
  auto& state = body.state();
  for (std::size_t i = 0; i < state.velocities.size(); ++i) {
    const Vec3& p = state.positions[i];
    const double stir = kStir * kBallRadius;
    const Vec3 any(random_share(random), random_share(random), random_share(random));
    state.velocities[i] = kSwing * frequency * (Vec3(p.x(), p.y(), -2 * p.z()) + stir * any);
  }
  const double volume_drift = scheme.keeps_volume ? kVolumeDrift : kAnything;
  if (scheme.model == "chainmail") {
    for (std::size_t i = 0; i < state.positions.size(); ++i) {
      state.positions[i] += state.velocities[i] / frequency;
    }
    const double energy = body.dynamics().elastic_energy(state);
    return {{energy, kAnything, volume_drift}, Energy::kElastic};
  }
  const double energy = deformation::kinetic_energy(body.model(), state.velocities);
  const bool exact = scheme.model == "modal";
  return {{energy, kEnergyDrift, volume_drift, exact}, exact ? Energy::kTotal : Energy::kMidway};
}

}  // namespace

Watch::Watch(const TestBody& body, const Tolerance& tolerance, Energy energy)
    : tolerance_(tolerance),
      energy_(energy),
      rest_(body.state().positions),
      before_(body.state().velocities) {}

bool Watch::see(TestBody& body) {
  const OrganModel& model = body.model();
  const auto& state = body.state();
  double together = 0, now = 0, then = 0, farthest = 0;
  auto mean = state.velocities;  // midway
  for (std::size_t i = 0; i < mean.size(); ++i) {
    together += model.masses[i] * before_[i].dot(state.velocities[i]);
    then += model.masses[i] * before_[i].squaredNorm();
    now += model.masses[i] * state.velocities[i].squaredNorm();
    const double way = (state.positions[i] - rest_[i]).norm();
    if (!(way <= farthest)) farthest = way;
    mean[i] = (before_[i] + state.velocities[i]) / 2;
  }
  const double product = std::sqrt(now * then);
  signals_.turning.push_back(product > 0 ? -together / product : 0);
  signals_.kinetic.push_back(now / 2);
  double energy = energy_ == Energy::kElastic ? 0 : now / 2;
  if (energy_ == Energy::kMidway) energy = deformation::kinetic_energy(model, mean);
  if (energy_ != Energy::kKinetic) energy += body.dynamics().elastic_energy(state);
  signals_.energy.push_back(energy);
  const double volume = geometry::enclosed_volume(state.positions, model.triangles);
  signals_.volume_error.push_back(std::abs(volume / model.rest_volume - 1));
  signals_.displacement.push_back(farthest / kBallRadius);
  // An implicit step of any length begins with a free flight: the energy that stores was there.
  if (energy_ != Energy::kKinetic && signals_.energy.size() == 1 &&
      std::isfinite(signals_.energy[0])) {
    tolerance_.energy = std::max(tolerance_.energy, signals_.energy[0]);
  }
  before_ = state.velocities;
  return !is_lost(signals_, tolerance_);
}

double inverted_share(const OrganModel& model, const std::vector<Vec3>& x) {
  if (model.is_solid()) {
    return double(deformation::inverted_tetrahedra(model.mesh(), x)) /
           double(model.mesh().tetrahedra.size());
  }
  const Mat3 rotation = best_rotation(model, x);
  const auto& rest = model.rest_positions;
  std::size_t turned = 0;
  for (const auto& [a, b, c] : model.triangles) {
    const Vec3 now = (x[b] - x[a]).cross(x[c] - x[a]);
    turned += !(now.dot(rotation * (rest[b] - rest[a]).cross(rest[c] - rest[a])) > 0);
  }
  return double(turned) / double(model.triangles.size());
}

Verdict Watch::judge(const TestBody& body) {
  signals_.inverted = inverted_share(body.model(), body.state().positions);
  return stability::judge(signals_, tolerance_);
}

Verdict swing(const Scheme& scheme, const geometry::OrganShape& shape, double youngs_modulus,
              double h, const KeepGoing& keep_going) {
  TestBody body(organ_of(scheme, youngs_modulus), shape);
  const Swing swing = swing_of(scheme, youngs_modulus, body);
  Watch watch(body, swing.tolerance, swing.energy);
  for (int s = 0; s < kSwingSteps; ++s) {
    if (s % 50 == 0) keep_going();
    body.dynamics().step(h, {}, body.state());
    if (!watch.see(body)) break;
  }
  return watch.judge(body);
}

scene::Organ squeezed_organ(const Scheme& scheme) {
  scene::Organ organ = organ_of(scheme, kYoungsModulus);
  organ.tissue.damping_ratio = kDampingRatio;
  organ.tissue.drag = kDrag;
  return organ;
}

Verdict squeeze(const Scheme& scheme, const geometry::OrganShape& shape, double squeeze, double h,
                const KeepGoing& keep_going, std::unique_ptr<TestBody>* end) {
  auto body = std::make_unique<TestBody>(squeezed_organ(scheme), shape);
  Watch watch(*body, driven(scheme, *body, 2 * squeeze * kBallRadius / kClosing), Energy::kKinetic);
  rigs::Plates plates(body->model(), kBallRadius);
  const int steps = static_cast<int>(std::ceil((kClosing + kHolding) / h));
  for (int s = 1; s <= steps; ++s) {
    keep_going();
    const double next = kBallRadius * (1 - squeeze * rigs::minimum_jerk(s * h / kClosing));
    const double way = std::abs(next - plates.height());
    plates.step(body->dynamics(), h, next, kNear + 2 * way, body->state());
    if (!watch.see(*body)) break;
  }
  const Verdict verdict = watch.judge(*body);
  if (end != nullptr) *end = std::move(body);
  return verdict;
}

scene::Organ poked_ball(const Scheme& scheme) {
  scene::Organ organ = squeezed_organ(scheme);
  organ.fixed.push_back(scene::BoxRegion{{-1, -1, -1}, {1, 1, -0.8 * kBallRadius}});
  return organ;
}

Verdict poke(const Scheme& scheme, const geometry::OrganShape& shape, double speed, double h,
             const KeepGoing& keep_going) {
  TestBody body(poked_ball(scheme), shape);
  Watch watch(body, driven(scheme, body, speed), Energy::kKinetic);
  rigs::Touch touch(body.model().surface_node_count);
  const double way = kDepth / speed;
  const int steps = static_cast<int>(std::ceil((2 * way + kHolding) / h));
  const auto depth_at = [&](double t) {
    return kDepth * std::max(-1.0, t < way ? t / way : 2 - t / way);
  };
  for (int s = 0; s < steps; ++s) {
    keep_going();
    const double depth = depth_at(s * h), next = depth_at((s + 1) * h);
    rigs::Obstacle sphere;
    sphere.position = (kBallRadius + kSphere - depth) * Vec3::UnitZ();
    sphere.velocity = (depth - next) / h * Vec3::UnitZ();
    sphere.radius = kSphere;
    touch.step(std::array{sphere}, kNear + 2 * h * sphere.velocity.norm(), h, body.dynamics(),
               body.state());
    if (!watch.see(body)) break;
  }
  return watch.judge(body);
}

}  // namespace palpate::stability
