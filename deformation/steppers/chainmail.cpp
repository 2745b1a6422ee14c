#include "deformation/steppers/chainmail.h"

#include <algorithm>
#include <cmath>

namespace palpate::deformation {
namespace {

/// What must be added to b − a so that the link is within its bounds; zero if it is.
Vec3 missing(const ChainMail::Link& link, const Vec3& along) {
  const double length = along.norm();
  const double allowed = std::clamp(length, ChainMail::kShortest * link.rest_length,
                                    ChainMail::kLongest * link.rest_length);
  return length == 0 ? Vec3::Zero() : Vec3((allowed / length - 1) * along);
}

}  // namespace

ChainMail::ChainMail(const OrganModel& model)
    : model_(model), links_of_(model.node_count()), kernel_(model, model.network(), false) {
  const SpringNetwork& network = model.network();
  for (std::size_t s = 0; s < network.springs.size(); ++s) {
    if (network.family(s) == SpringFamily::kBending) continue;
    const Spring& spring = network.springs[s];
    for (const std::uint32_t node : {spring.node_a, spring.node_b}) {
      links_of_[node].push_back(static_cast<std::uint32_t>(links_.size()));
    }
    links_.push_back({spring.node_a, spring.node_b, spring.rest_length});
  }
}

void ChainMail::relax(OrganState& state) {
  // From rest, a free step of 1 s leaves the velocity F/m + gravity.
  std::fill(state.velocities.begin(), state.velocities.end(), Vec3::Zero());
  kernel_.free_step(1, state, free_);
  for (std::size_t i = 0; i < model_.node_count(); ++i) {
    if (model_.inverse_masses[i] == 0) continue;
    const Vec3 force = model_.masses[i] * (free_.velocities[i] - model_.gravity);
    const Vec3 move = (kRelaxation / model_.node_stiffness[i]) * force;
    if (move.squaredNorm() > kStill * kStill) state.positions[i] += move;
  }
}

void ChainMail::push(double h, ContactRow& row, std::vector<Vec3>& positions) {
  row.normal_impulse = 0;
  row.tangential_impulse = Vec3::Zero();
  double gap = std::max(row.gap, -kMaxSeparationSpeed * h) + h * row.normal.dot(row.probe_velocity),
         squared_weights = 0;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t node = row.nodes[k];
    gap -= row.weights[k] * row.normal.dot(positions[node] - old_positions_[node]);
    if (model_.inverse_masses[node] > 0 || row.yielding > 0)
      squared_weights += row.weights[k] * row.weights[k];
  }
  if (gap >= 0 || squared_weights == 0) return;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t node = row.nodes[k];
    if (row.weights[k] == 0 || model_.inverse_masses[node] == 0) continue;
    const double distance = -gap * row.weights[k] / squared_weights;
    positions[node] -= distance * row.normal;
    row.normal_impulse += h * model_.node_stiffness[node] * distance / kRelaxation;
    held_[node] = true;
    if (!queued_[node]) queue_.push_back(node);
    queued_[node] = true;
  }
}

void ChainMail::spread(std::vector<Vec3>& positions) {
  for (std::size_t next = 0; next < queue_.size(); ++next) {
    const std::uint32_t from = queue_[next];
    done_[from] = true;
    for (const std::uint32_t index : links_of_[from]) {
      const Link& link = links_[index];
      const std::uint32_t to = link.node_a == from ? link.node_b : link.node_a;
      if (done_[to] || held_[to]) continue;
      const Vec3 move = missing(link, positions[to] - positions[from]);
      if (move.isZero(0)) continue;
      positions[to] += move;
      if (!queued_[to]) queue_.push_back(to);
      queued_[to] = true;
    }
  }
}

void ChainMail::sweep_links(std::vector<Vec3>& positions) const {
  double worst = 1;
  for (int sweep = 0; sweep < kMaxSweeps && worst > kBoundTolerance; ++sweep) {
    worst = 0;
    for (const Link& link : links_) {
      const Vec3 move = missing(link, positions[link.node_b] - positions[link.node_a]);
      const double free_a = held_[link.node_a] ? 0 : 1, free_b = held_[link.node_b] ? 0 : 1;
      if (move.isZero(0) || free_a + free_b == 0) continue;
      worst = std::max(worst, move.norm() / link.rest_length);
      positions[link.node_a] -= (free_a / (free_a + free_b)) * move;
      positions[link.node_b] += (free_b / (free_a + free_b)) * move;
    }
  }
}

StepReport ChainMail::step(double h, std::span<ContactRow> rows, OrganState& state) {
  old_positions_ = state.positions;
  queue_.clear();
  queued_.assign(model_.node_count(), false);
  done_.assign(model_.node_count(), false);
  held_.assign(model_.node_count(), false);
  for (const std::uint32_t node : model_.fixed_nodes) held_[node] = true;

  relax(state);
  for (ContactRow& row : rows) push(h, row, state.positions);
  spread(state.positions);
  if (!queue_.empty()) sweep_links(state.positions);
  for (std::size_t i = 0; i < model_.node_count(); ++i) {
    state.velocities[i] = (state.positions[i] - old_positions_[i]) / h;
  }
  state.pressure = 0;
  return {};
}

}  // namespace palpate::deformation
