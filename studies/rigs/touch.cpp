#include "studies/rigs/touch.h"

#include <algorithm>

namespace palpate::rigs {
namespace {

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

}  // namespace

void Touch::step(std::span<const Obstacle> obstacles, double near, double h,
                 deformation::OrganDynamics& dynamics, deformation::OrganState& state) {
  impulses_.resize(obstacles.size() * nodes_, 0);
  rows_.clear();
  slots_.clear();
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    for (std::uint32_t i = 0; i < nodes_; ++i) {
      deformation::ContactRow row;
      row.gap = gap_of(obstacles[k], state.positions[i], row.normal);
      if (!(row.gap < near)) continue;
      row.nodes = {i, i, i};
      row.weights = Vec3::UnitX();
      row.probe_velocity = obstacles[k].velocity;
      row.normal_impulse = impulse(k, i);
      rows_.push_back(row);
      slots_.push_back(k * nodes_ + i);
    }
  }
  dynamics.step(h, rows_, state);
  std::fill(impulses_.begin(), impulses_.end(), 0);
  for (std::size_t r = 0; r < rows_.size(); ++r) impulses_[slots_[r]] = rows_[r].normal_impulse;
}

}  // namespace palpate::rigs
