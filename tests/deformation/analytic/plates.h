// A ball between two rigid plates, one contact row per node: for tests that look at every step.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "deformation/steppers/organ_dynamics.h"
#include "modules/geometry/triangle_surface.h"

namespace palpate::deformation::testing {

/// Two plates at z = ±height that close with a minimum-jerk motion and then hold. Frictionless.
class Plates {
 public:
  Plates(const OrganModel& model, double height) : model_(model), height_(height) {
    impulses_.resize(2 * model.surface_node_count, 0);
  }

  double height() const { return height_; }
  /// Of the upper plate, in the last step [N].
  double force() const { return force_; }
  /// Σ (∂V/∂x)_z of the nodes the upper plate held in the last step: its contact area [m²].
  double contact_area(const OrganState& state) const {
    VolumeGradient volume;
    evaluate_volume(model_, state.positions, volume);
    double area = 0;
    for (std::size_t i = 0; i < model_.surface_node_count; ++i) {
      if (impulses_[2 * i] > 0) area += volume.gradient[i].z();
    }
    return area;
  }

  void step(OrganDynamics& dynamics, double h, double new_height, OrganState& state) {
    rows_.clear();
    slots_.clear();
    for (const int side : {1, -1}) {
      for (std::uint32_t i = 0; i < model_.surface_node_count; ++i) {
        const double gap = height_ - side * state.positions[i].z();
        if (gap < 0.1 * height_) add_row(i, side, gap, (new_height - height_) / h);
      }
    }
    height_ = new_height;
    dynamics.step(h, rows_, state);
    std::fill(impulses_.begin(), impulses_.end(), 0);
    force_ = 0;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      impulses_[slots_[r]] = rows_[r].normal_impulse;
      if (slots_[r] % 2 == 0) force_ += rows_[r].normal_impulse / h;
    }
  }

 private:
  void add_row(std::uint32_t node, int side, double gap, double plate_speed) {
    slots_.push_back(2 * node + (side > 0 ? 0 : 1));
    ContactRow row;
    row.nodes = {node, node, node};
    row.weights = Vec3::UnitX();
    row.normal = Vec3(0, 0, side);
    row.gap = gap;
    row.probe_velocity = Vec3(0, 0, side * plate_speed);
    row.normal_impulse = impulses_[slots_.back()];
    rows_.push_back(row);
  }

  const OrganModel& model_;
  double height_, force_ = 0;
  std::vector<ContactRow> rows_;
  std::vector<std::size_t> slots_;
  std::vector<double> impulses_;  ///< [2 node + plate], upper plate first [N·s]
};

struct SqueezeErrors {
  double peak = 0, held = 0;  ///< largest |V−V*|/V* while moving, and in the last half second
};

/// Squeezes from `plates.height()` by `compression` in `seconds` and holds for `hold` ≥ 0.5 s.
inline SqueezeErrors squeeze(const OrganModel& model, OrganDynamics& dynamics, double h,
                             double compression, double seconds, double hold, Plates& plates,
                             OrganState& state) {
  SqueezeErrors errors;
  const double start = plates.height();
  const int moving = static_cast<int>(std::ceil(seconds / h));
  const int last = moving + static_cast<int>(std::ceil(hold / h));
  for (int s = 1; s <= last; ++s) {
    const double t = std::min(1.0, static_cast<double>(s) / moving);
    const double part = t * t * t * (10 + t * (6 * t - 15));
    plates.step(dynamics, h, start * (1 - compression * part), state);
    const double volume = geometry::enclosed_volume(state.positions, model.triangles);
    const double error = std::abs(volume / state.target_volume - 1);
    double& worst = s * h > seconds + hold - 0.5 ? errors.held : errors.peak;
    worst = std::max(worst, error);
  }
  return errors;
}

}  // namespace palpate::deformation::testing
