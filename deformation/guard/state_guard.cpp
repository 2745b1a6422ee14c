#include "deformation/guard/state_guard.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "modules/geometry/triangle_surface.h"

namespace palpate::deformation {
namespace {

/// Σ m x of the nodes that move [kg·m].
Vec3 first_moment(const OrganModel& model, const std::vector<Vec3>& positions) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (model.inverse_masses[i] > 0) sum += model.masses[i] * positions[i];
  }
  return sum;
}

double moving_mass(const OrganModel& model) {
  double sum = 0;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    if (model.inverse_masses[i] > 0) sum += model.masses[i];
  }
  return sum;
}

/// At most twice the largest distance from the first node.
double largest_rest_distance(const OrganModel& model) {
  double squared = 0;
  for (const Vec3& p : model.network.rest_positions) {
    squared = std::max(squared, (p - model.network.rest_positions[0]).squaredNorm());
  }
  return std::sqrt(squared);
}

}  // namespace

bool knows_energy(scene::Model model) {
  switch (model) {
    case scene::Model::kPenalty:
    case scene::Model::kPromayon:
    case scene::Model::kBourguignonCani:
    case scene::Model::kZordan:
    case scene::Model::kElementVolume:
    case scene::Model::kChainMail:
      return false;
    default:
      return true;
  }
}

StateGuard::StateGuard(const OrganModel& model, bool knows_energy)
    : model_(model),
      knows_energy_(knows_energy),
      total_mass_(moving_mass(model)),
      largest_distance_(kMaxGrowth * largest_rest_distance(model)),
      calm_energy_(total_mass_ * kCalmSpeed * kCalmSpeed / 2),
      largest_unpaid_(total_mass_ * kMaxSeparationSpeed * kMaxSeparationSpeed) {}

void StateGuard::begin(const OrganState& state, double elastic_energy) {
  double kinetic = 0;
  for (std::size_t i = 0; i < state.velocities.size(); ++i) {
    kinetic += model_.masses[i] * state.velocities[i].squaredNorm() / 2;
  }
  // Tissue pressed flat may have no energy that is a number; it is judged from the next look on.
  ledger_ =
      std::isfinite(elastic_energy) ? kinetic + elastic_energy : std::numeric_limits<double>::max();
  unpaid_ = 0;
  first_moment_ = first_moment(model_, state.positions);
  seen_ = state.positions;
  suspicious_ = false;
}

void StateGuard::add_work(double h, std::span<const ContactRow> rows, double volume_change,
                          const OrganState& state) {
  unpaid_ -= std::min(h / kUnpaidMemory, 1.0) * unpaid_;
  for (const ContactRow& row : rows) {
    Vec3 velocity = Vec3::Zero();
    for (int k = 0; k < 3; ++k) velocity += row.weights[k] * state.velocities[row.nodes[k]];
    const Vec3 impulse = row.tangential_impulse - row.normal_impulse * row.normal;
    ledger_ += impulse.dot(velocity);
    const Vec3 parting = velocity - row.probe_velocity;
    if (-row.normal.dot(parting) > kPushedSpeed) unpaid_ += std::max(0.0, impulse.dot(parting));
  }
  ledger_ += state.pressure * volume_change;
}

/// Of the pressure and, by the ledger, of every impulse since the last look.
bool StateGuard::is_finite(const OrganState& state) const {
  return std::isfinite(state.pressure) && std::isfinite(ledger_);
}

Disbelief StateGuard::look(const OrganState& state, double period) {
  const double way = period * period * kMaxNodeSpeed * kMaxNodeSpeed;
  const double far = largest_distance_ * largest_distance_;
  const double fast = kMaxNodeSpeed * kMaxNodeSpeed;
  const Vec3 first = state.positions[0];
  double twice_energy = 0;
  bool sound = is_finite(state);
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    const double speed = state.velocities[i].squaredNorm();
    const double distance = (state.positions[i] - first).squaredNorm();
    const double moved = (state.positions[i] - seen_[i]).squaredNorm();
    sound &= (speed <= fast) & (moved <= way) & (distance <= far);  // false for NaN
    twice_energy += model_.masses[i] * speed;
  }
  suspicious_ = false;
  if (!sound) return explain(state, period);
  seen_ = state.positions;
  kinetic_energy_ = twice_energy / 2;
  if (!model_.gravity.isZero(0)) {
    const Vec3 moment = first_moment(model_, state.positions);
    ledger_ += model_.gravity.dot(moment - first_moment_);
    first_moment_ = moment;
  }
  return judge_energy(kinetic_energy_);
}

Disbelief StateGuard::look_thoroughly(const OrganState& state, double period,
                                      OrganDynamics& dynamics) {
  const Disbelief seen = look(state, period);
  if (seen != Disbelief::kNone) return seen;
  const double volume = geometry::enclosed_volume(state.positions, model_.triangles);
  if (volume < -kTurnedVolume * model_.rest_volume) return Disbelief::kTurnedInside;
  if (!knows_energy_) return Disbelief::kNone;
  const double energy = kinetic_energy_ + dynamics.elastic_energy(state);
  const bool was_suspicious = suspicious_;
  const Disbelief judged = judge_energy(energy);
  suspicious_ |= was_suspicious;
  if (judged == Disbelief::kNone) ledger_ = std::min(ledger_, energy);
  return judged;
}

/// @param energy  all or part of what the organ holds [J]
Disbelief StateGuard::judge_energy(double energy) {
  if (!knows_energy_) return Disbelief::kNone;
  const double may_hold = std::max(ledger_, 0.0) + calm_energy_;
  suspicious_ = energy > kSuspiciousGain * may_hold;
  const bool shaken = unpaid_ > largest_unpaid_ && kinetic_energy_ > calm_energy_;
  return shaken || energy > kEnergyGain * may_hold ? Disbelief::kEnergyGrew : Disbelief::kNone;
}

Disbelief StateGuard::explain(const OrganState& state, double period) const {
  bool finite = is_finite(state);
  double speed = 0;
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    finite &= state.positions[i].allFinite() && state.velocities[i].allFinite();
    speed = std::max(
        {speed, state.velocities[i].norm(), (state.positions[i] - seen_[i]).norm() / period});
  }
  if (!finite) return Disbelief::kNotFinite;
  return speed > kMaxNodeSpeed ? Disbelief::kTooFast : Disbelief::kTooLarge;
}

std::size_t inverted_tetrahedra(const OrganModel& model, const std::vector<Vec3>& positions) {
  return static_cast<std::size_t>(std::count_if(model.solid.tetrahedra.begin(),
                                                model.solid.tetrahedra.end(),
                                                [&](const geometry::Tetrahedron& t) {
                                                  const Vec3 a = positions[t[1]] - positions[t[0]];
                                                  const Vec3 b = positions[t[2]] - positions[t[0]];
                                                  const Vec3 c = positions[t[3]] - positions[t[0]];
                                                  return !(a.dot(b.cross(c)) > 0);
                                                }));
}

}  // namespace palpate::deformation
