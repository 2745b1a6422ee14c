#include "deformation/guard/divergence_detector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "modules/geometry/triangle_surface.h"

namespace palpate::deformation {
namespace {

/// Σ m x of the nodes that move [kg·m].
Vec3 first_moment(const Body& body, const std::vector<Vec3>& positions) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (body.inverse_masses[i] > 0) sum += body.masses[i] * positions[i];
  }
  return sum;
}

double moving_mass(const Body& body) {
  double sum = 0;
  for (std::size_t i = 0; i < body.node_count(); ++i) {
    if (body.inverse_masses[i] > 0) sum += body.masses[i];
  }
  return sum;
}

/// At most twice the largest distance from the first node.
double largest_rest_distance(const Body& body) {
  double squared = 0;
  for (const Vec3& p : body.rest_positions) {
    squared = std::max(squared, (p - body.rest_positions[0]).squaredNorm());
  }
  return std::sqrt(squared);
}

}  // namespace

DivergenceDetector::DivergenceDetector(const Body& body, bool knows_energy, ChunkRunner* runner)
    : body_(body),
      knows_energy_(knows_energy),
      ranges_(runner),
      total_mass_(moving_mass(body)),
      largest_distance_(kMaxGrowth * largest_rest_distance(body)),
      calm_energy_(total_mass_ * kCalmSpeed * kCalmSpeed / 2),
      largest_injected_energy_(total_mass_ * kMaxSeparationSpeed * kMaxSeparationSpeed) {}

void DivergenceDetector::begin(const OrganState& state, double elastic_energy) {
  double kinetic = 0;
  for (std::size_t i = 0; i < state.velocities.size(); ++i) {
    kinetic += body_.masses[i] * state.velocities[i].squaredNorm() / 2;
  }
  // Tissue pressed flat may have no energy that is a number; it is judged from the next check on.
  energy_budget_ =
      std::isfinite(elastic_energy) ? kinetic + elastic_energy : std::numeric_limits<double>::max();
  injected_energy_ = shaken_time_ = 0;
  first_moment_ = first_moment(body_, state.positions);
  seen_ = state.positions;
  suspicious_ = false;
  stop_looking();
}

void DivergenceDetector::take_over(const DivergenceDetector& before, const OrganState& state) {
  energy_budget_ = before.energy_budget_;
  injected_energy_ = before.injected_energy_;
  shaken_time_ = before.shaken_time_;
  kinetic_energy_ = before.kinetic_energy_;
  suspicious_ = before.suspicious_;
  energy_ = before.energy_;
  paid_work_ = before.paid_work_;
  was_fast_ = before.was_fast_;
  first_moment_ = first_moment(body_, state.positions);
  seen_ = state.positions;
}

void DivergenceDetector::add_work(double h, std::span<const ContactRow> rows, double volume_change,
                                  const OrganState& state) {
  injected_energy_ -= std::min(h / kInjectionMemory, 1.0) * injected_energy_;
  for (const ContactRow& row : rows) {
    const Vec3 velocity = at_tissue(row, state.velocities);
    const Vec3 impulse = row.tangential_impulse - row.normal_impulse * row.normal;
    const double work = impulse.dot(velocity);
    energy_budget_ += work;
    paid_work_ += work;
    const Vec3 parting = velocity - row.probe_velocity;
    const double pushed = -row.normal.dot(parting);
    if (!(pushed > kPushedSpeed && pushed > row.probe_velocity.norm())) continue;
    const double injected = std::max(0.0, impulse.dot(parting));
    injected_energy_ += injected;
    paid_work_ -= injected;
  }
  give(state.pressure * volume_change);
}

/// No organ holds less than nothing: work that takes more from it was overestimated. A budget that
/// is no number stays so.
void DivergenceDetector::give(double work) {
  energy_budget_ += work;
  paid_work_ += work;
  if (energy_budget_ < 0) energy_budget_ = 0;
}

/// Of the pressure and, by the energy budget, of every impulse since the last check.
bool DivergenceDetector::is_finite(const OrganState& state) const {
  return std::isfinite(state.pressure) && std::isfinite(energy_budget_);
}

/// Of all nodes, since they were seen last. @param period  since then [s]
DivergenceDetector::Motion DivergenceDetector::motion_of(const OrganState& state, double period) {
  const double way = period * period * kMaxNodeSpeed * kMaxNodeSpeed;
  const double far = largest_distance_ * largest_distance_;
  const double fastest = kMaxNodeSpeed * kMaxNodeSpeed;
  const Vec3 first_node = state.positions[0];
  const std::size_t nodes = state.positions.size();
  motions_.assign(Ranges::count_of(nodes), Motion());
  ranges_.each(nodes, [&](std::size_t first, std::size_t last) {
    Motion of_range;
    for (std::size_t i = first; i < last; ++i) {
      const double speed = state.velocities[i].squaredNorm();
      const double distance = (state.positions[i] - first_node).squaredNorm();
      const Vec3 went = state.positions[i] - seen_[i];
      const double moved = went.squaredNorm();
      of_range.sound &= (speed <= fastest) & (moved <= way) & (distance <= far);  // false for NaN
      of_range.twice_energy += body_.masses[i] * speed;
      of_range.momentum += body_.masses[i] * state.velocities[i];
      if (body_.inverse_masses[i] > 0) of_range.moment += body_.masses[i] * state.positions[i];
      if (i >= body_.surface_node_count) continue;
      of_range.squares += moved;
      of_range.way += went;
    }
    motions_[first / Ranges::kSize] = of_range;
  });
  Motion all;
  for (const Motion& of_range : motions_) {
    all.sound &= of_range.sound;
    all.twice_energy += of_range.twice_energy;
    all.squares += of_range.squares;
    all.momentum += of_range.momentum;
    all.moment += of_range.moment;
    all.way += of_range.way;
  }
  return all;
}

Violation DivergenceDetector::check_bounds(const OrganState& state, double period) {
  const Motion motion = motion_of(state, period);
  suspicious_ = false;
  if (!(motion.sound && is_finite(state))) return explain(state, period);
  ranges_.each(seen_.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) seen_[i] = state.positions[i];
  });
  kinetic_energy_ = motion.twice_energy / 2;
  inner_energy_ = kinetic_energy_ - motion.momentum.squaredNorm() / (2 * total_mass_);
  const auto count = static_cast<double>(body_.surface_node_count);
  shaking_squared_ =
      (motion.squares / count - (motion.way / count).squaredNorm()) / (period * period);
  const bool fast = shaking_squared_ > kShakenForLongSpeed * kShakenForLongSpeed;
  shaken_time_ = fast ? shaken_time_ + period : 0;
  give(body_.gravity.dot(motion.moment - first_moment_));
  first_moment_ = motion.moment;
  suspicious_ = knows_energy_ && inner_energy_ > kSuspiciousGain * may_hold();
  return Violation::kNone;
}

Violation DivergenceDetector::check(const OrganState& state, double period,
                                    OrganDynamics& dynamics) {
  const Violation seen = check_bounds(state, period);
  if (seen != Violation::kNone) return seen;
  if (moves()) return look_closely(state, dynamics);
  stop_looking();
  return Violation::kNone;
}

void DivergenceDetector::stop_looking() {
  energy_ = paid_work_ = 0;
  was_fast_ = false;
}

Violation DivergenceDetector::check_thoroughly(const OrganState& state, double period,
                                               OrganDynamics& dynamics) {
  Violation seen = check_bounds(state, period);
  if (seen == Violation::kNone) seen = look_closely(state, dynamics);
  if (seen != Violation::kNone || !knows_energy_) return seen;
  const double moved_as_a_whole = kinetic_energy_ - inner_energy_;
  suspicious_ |= energy_ - moved_as_a_whole > kSuspiciousGain * may_hold();
  energy_budget_ = std::min(energy_budget_, energy_);
  return Violation::kNone;
}

/// Faster than one push out of a probe makes it.
bool DivergenceDetector::moves() const {
  return shaking_squared_ > kShakenForLongSpeed * kShakenForLongSpeed ||
         inner_energy_ > total_mass_ * kShakenForLongSpeed * kShakenForLongSpeed / 2;
}

/// No organ holds less than nothing: stored energy below 0 is none, what it moves nobody gave. What
/// is no number is more than any.
Violation DivergenceDetector::look_closely(const OrganState& state, OrganDynamics& dynamics) {
  const double volume = geometry::enclosed_volume(state.positions, body_.triangles);
  if (volume < -kTurnedVolume * body_.rest_volume) return Violation::kTurnedInside;
  if (!knows_energy_) return Violation::kNone;
  const double before = std::exchange(energy_, 0);
  const double paid = std::max(std::exchange(paid_work_, 0), 0.0);
  const bool was_fast = was_fast_, for_long = shaken_time_ > kShakenTime;
  energy_ = kinetic_energy_ + std::max(dynamics.elastic_energy(state), 0.0);
  const bool shakes = for_long || shaking_squared_ > kShakenSpeed * kShakenSpeed;
  const bool hurries = for_long || inner_energy_ > total_mass_ * kShakenSpeed * kShakenSpeed / 2;
  was_fast_ = shakes || hurries;
  const bool grows =
      before > 0 ? !(energy_ <= kEnergyGain * before) || (was_fast && energy_ > before + paid)
                 : !(inner_energy_ <= energy_ / kEnergyGain);
  const bool shaken = shakes && injected_energy_ > largest_injected_energy_;
  const bool unearned =
      hurries && inner_energy_ > std::max(kEnergyGain * may_hold(), energy_ / kEnergyGain);
  return grows && (shaken || unearned) ? Violation::kEnergyGrew : Violation::kNone;
}

Violation DivergenceDetector::explain(const OrganState& state, double period) const {
  bool finite = is_finite(state);
  double speed = 0;
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    finite &= state.positions[i].allFinite() && state.velocities[i].allFinite();
    speed = std::max(
        {speed, state.velocities[i].norm(), (state.positions[i] - seen_[i]).norm() / period});
  }
  if (!finite) return Violation::kNotFinite;
  return speed > kMaxNodeSpeed ? Violation::kTooFast : Violation::kTooLarge;
}

}  // namespace palpate::deformation
