#include "studies/stability/runs.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <random>

#include "deformation/guard/state_guard.h"
#include "deformation/springs/spring_forces.h"

namespace palpate::stability {
namespace {

using deformation::ContactRow;
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
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double turn = svd.matrixU().determinant() * svd.matrixV().determinant();
  return svd.matrixU() * Vec3(1, 1, turn < 0 ? -1 : 1).asDiagonal() * svd.matrixV().transpose();
}

/// Of a node on the obstacle's free side, and the normal from tissue to probe.
double gap_of(const Obstacle& obstacle, const Vec3& x, Vec3& normal) {
  if (obstacle.radius == 0) {
    normal = -obstacle.facing;
    return obstacle.facing.dot(x - obstacle.position);
  }
  const Vec3 inward = obstacle.position - x;
  const double distance = inward.norm();
  normal = distance > 0 ? Vec3(inward / distance) : Vec3::UnitZ();
  return distance - obstacle.radius;
}

double eased(double share) {
  const double t = std::clamp(share, 0.0, 1.0);
  return t * t * t * (10 + t * (6 * t - 15));
}

Yardstick driven(const Subject& subject, const Specimen& specimen, double speed) {
  const double fastest = speed + kHonestSpeed;
  return {0.5 * specimen.mass() * fastest * fastest, kAnything,
          subject.keeps_volume ? kVolumeDrift : kAnything};
}

/// How a free ball's motion is judged.
struct Swing {
  Yardstick yardstick;
  Energy energy = Energy::kMidway;
};

/// Sets the specimen swinging.
Swing swing_of(const Subject& subject, double youngs_modulus, Specimen& specimen) {
  // The ellipsoid mode of this ball swings at about 30 rad/s at 10 kPa; solid ones a little faster.
  const double frequency = 30 * std::sqrt(youngs_modulus / 10e3);
  std::mt19937 random(1);
  auto& state = specimen.state();
  for (std::size_t i = 0; i < state.velocities.size(); ++i) {
    const Vec3& p = state.positions[i];
    const double stir = kStir * kRadius;
    const Vec3 any(random_share(random), random_share(random), random_share(random));
    state.velocities[i] = kSwing * frequency * (Vec3(p.x(), p.y(), -2 * p.z()) + stir * any);
  }
  const double volume_drift = subject.keeps_volume ? kVolumeDrift : kAnything;
  if (subject.model == scene::Model::kChainMail) {
    for (std::size_t i = 0; i < state.positions.size(); ++i) {
      state.positions[i] += state.velocities[i] / frequency;
    }
    const double energy = specimen.dynamics().elastic_energy(state);
    return {{energy, kAnything, volume_drift}, Energy::kElastic};
  }
  const double energy = deformation::kinetic_energy(specimen.model(), state.velocities);
  const bool exact = subject.model == scene::Model::kModal;
  return {{energy, kEnergyDrift, volume_drift, exact}, exact ? Energy::kTotal : Energy::kMidway};
}

}  // namespace

void Touch::step(std::span<const Obstacle> obstacles, double h, Specimen& specimen) {
  const std::size_t nodes = specimen.model().surface_node_count;
  impulses_.resize(obstacles.size() * nodes, 0);
  rows_.clear();
  slots_.clear();
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    for (std::uint32_t i = 0; i < nodes; ++i) {
      ContactRow row;
      row.gap = gap_of(obstacles[k], specimen.state().positions[i], row.normal);
      if (!(row.gap < kNear + 2 * h * obstacles[k].velocity.norm())) continue;
      row.nodes = {i, i, i};
      row.weights = Vec3::UnitX();
      row.probe_velocity = obstacles[k].velocity;
      row.normal_impulse = impulses_[k * nodes + i];
      rows_.push_back(row);
      slots_.push_back(k * nodes + i);
    }
  }
  specimen.dynamics().step(h, rows_, specimen.state());
  std::fill(impulses_.begin(), impulses_.end(), 0);
  for (std::size_t r = 0; r < rows_.size(); ++r) impulses_[slots_[r]] = rows_[r].normal_impulse;
}

Watch::Watch(const Specimen& specimen, const Yardstick& yardstick, Energy energy)
    : yardstick_(yardstick),
      energy_(energy),
      rest_(specimen.state().positions),
      before_(specimen.state().velocities) {}

bool Watch::see(Specimen& specimen) {
  const OrganModel& model = specimen.model();
  const auto& state = specimen.state();
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
  if (energy_ != Energy::kKinetic) energy += specimen.dynamics().elastic_energy(state);
  signals_.energy.push_back(energy);
  const double volume = geometry::enclosed_volume(state.positions, model.triangles);
  signals_.volume_error.push_back(std::abs(volume / model.rest_volume - 1));
  signals_.displacement.push_back(farthest / kRadius);
  // An implicit step of any length begins with a free flight: the energy that stores was there.
  if (energy_ != Energy::kKinetic && signals_.energy.size() == 1 &&
      std::isfinite(signals_.energy[0])) {
    yardstick_.energy = std::max(yardstick_.energy, signals_.energy[0]);
  }
  before_ = state.velocities;
  return !is_lost(signals_, yardstick_);
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

Verdict Watch::judge(const Specimen& specimen) {
  signals_.inverted = inverted_share(specimen.model(), specimen.state().positions);
  return stability::judge(signals_, yardstick_);
}

Verdict swing(const Subject& subject, const geometry::OrganShape& shape, double youngs_modulus,
              double h, const KeepGoing& keep_going) {
  Specimen specimen(organ_of(subject, youngs_modulus), shape);
  const Swing swing = swing_of(subject, youngs_modulus, specimen);
  Watch watch(specimen, swing.yardstick, swing.energy);
  for (int s = 0; s < kSwingSteps; ++s) {
    if (s % 50 == 0) keep_going();
    specimen.dynamics().step(h, {}, specimen.state());
    if (!watch.see(specimen)) break;
  }
  return watch.judge(specimen);
}

scene::Organ squeezed_organ(const Subject& subject) {
  scene::Organ organ = organ_of(subject, kYoungsModulus);
  organ.tissue.damping_ratio = kDampingRatio;
  organ.tissue.drag = kDrag;
  return organ;
}

Verdict squeeze(const Subject& subject, const geometry::OrganShape& shape, double squeeze, double h,
                const KeepGoing& keep_going, std::unique_ptr<Specimen>* end) {
  auto specimen = std::make_unique<Specimen>(squeezed_organ(subject), shape);
  Watch watch(*specimen, driven(subject, *specimen, 2 * squeeze * kRadius / kClosing),
              Energy::kKinetic);
  Touch touch;
  const int steps = static_cast<int>(std::ceil((kClosing + kHolding) / h));
  double height = kRadius;
  for (int s = 1; s <= steps; ++s) {
    keep_going();
    const double next = kRadius * (1 - squeeze * eased(s * h / kClosing));
    const Vec3 position = height * Vec3::UnitZ(), velocity = (next - height) / h * Vec3::UnitZ();
    touch.step(std::array<Obstacle, 2>{{{position, velocity, 0, -Vec3::UnitZ()},
                                        {-position, -velocity, 0, Vec3::UnitZ()}}},
               h, *specimen);
    height = next;
    if (!watch.see(*specimen)) break;
  }
  const Verdict verdict = watch.judge(*specimen);
  if (end != nullptr) *end = std::move(specimen);
  return verdict;
}

scene::Organ poked_organ(const Subject& subject) {
  scene::Organ organ = squeezed_organ(subject);
  organ.fixed.push_back(scene::BoxRegion{{-1, -1, -1}, {1, 1, -0.8 * kRadius}});
  return organ;
}

Verdict poke(const Subject& subject, const geometry::OrganShape& shape, double speed, double h,
             const KeepGoing& keep_going) {
  Specimen specimen(poked_organ(subject), shape);
  Watch watch(specimen, driven(subject, specimen, speed), Energy::kKinetic);
  Touch touch;
  const double way = kDepth / speed;
  const int steps = static_cast<int>(std::ceil((2 * way + kHolding) / h));
  const auto depth_at = [&](double t) {
    return kDepth * std::max(-1.0, t < way ? t / way : 2 - t / way);
  };
  for (int s = 0; s < steps; ++s) {
    keep_going();
    const double depth = depth_at(s * h), next = depth_at((s + 1) * h);
    Obstacle sphere;
    sphere.position = (kRadius + kSphere - depth) * Vec3::UnitZ();
    sphere.velocity = (depth - next) / h * Vec3::UnitZ();
    sphere.radius = kSphere;
    touch.step(std::array{sphere}, h, specimen);
    if (!watch.see(specimen)) break;
  }
  return watch.judge(specimen);
}

}  // namespace palpate::stability
