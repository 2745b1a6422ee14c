// A solid organ between two frictionless plates, without collision and world.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "deformation/model/organ_model.h"
#include "deformation/models.h"
#include "modules/geometry/organ_shape.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/scene/models.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::deformation::testing {

/// Ball of reference A: R 5 cm, E 5 kPa, ν 0.499.
inline scene::Organ reference_ball(const std::string& model) {
  scene::Organ organ;
  organ.name = "ball";
  organ.model = model;
  organ.tissue.youngs_modulus = 5e3;
  organ.tissue.density = 1060;
  return organ;
}

/// Meshed by Gmsh; the middles of a quadratic one's outer edges lie on the sphere, too.
/// @param size  wanted edge length [m]
inline geometry::OrganShape ball_shape(const std::string& model, double radius, double size) {
  auto shape = geometry::shape_of(
      geometry::mesh_ball(radius, geometry::BallPart::kWhole, std::to_string(size)));
  if (!scene::is_quadratic(model)) return shape;
  shape = geometry::with_edge_nodes(shape);
  for (Vec3& node : shape.surface.nodes) node *= radius / node.norm();
  return shape;
}

/// Cube of 6 cm about the origin, cells³ cubes of six tetrahedra.
inline OrganModel block_model(const scene::Organ& organ, int cells,
                              const Vec3& gravity = Vec3::Zero()) {
  auto mesh = geometry::testing::block(Vec3::Constant(0.06), cells, cells, cells);
  for (Vec3& node : mesh.nodes) node -= Vec3::Constant(0.03);
  auto shape = geometry::shape_of(mesh);
  if (scene::is_quadratic(organ.model)) shape = geometry::with_edge_nodes(shape);
  return build_organ_model(organ, gravity, shape);
}

/// Oracle: nothing pulls, so nothing may move.
inline void check_stays_at_rest(const OrganModel& model, OrganDynamics& dynamics,
                                double tolerance) {
  OrganState state = rest_state(model);
  for (int k = 0; k < 20; ++k) dynamics.step(dynamics.largest_step(), {}, state);
  double moved = 0;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    moved = std::max(moved, (state.positions[i] - model.rest_positions[i]).norm());
  }
  CHECK(moved <= tolerance);
}

/// Of which velocity a step takes drag: that it begins with, or ends with.
enum class DragOf { kBefore, kAfter };

/// Oracle: analytic. Free fall with drag: v⁺ = v + h (g − drag v), by backward Euler
/// (v + h g)/(1 + h·drag).
inline void check_free_fall(const OrganModel& model, OrganDynamics& dynamics, DragOf drag) {
  const double h = dynamics.largest_step() / 2;
  OrganState state = rest_state(model);
  Vec3 velocity = Vec3::Zero(), fallen = Vec3::Zero();
  for (int k = 0; k < 30; ++k) {
    dynamics.step(h, {}, state);
    if (drag == DragOf::kBefore) {
      velocity += h * (model.gravity - model.drag * velocity);
    } else {
      velocity = (velocity + h * model.gravity) / (1 + h * model.drag);
    }
    fallen += h * velocity;
  }
  double error = 0;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    error = std::max(error, (state.positions[i] - model.rest_positions[i] - fallen).norm());
  }
  CHECK(error < 1e-7 * fallen.norm());
}

inline double rest_error(const OrganModel& model, const OrganState& state) {
  double worst = 0;  // of the distances from the middle, which a free turn leaves alone
  Vec3 middle = Vec3::Zero(), rest_middle = Vec3::Zero();
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    middle += state.positions[i] / static_cast<double>(model.node_count());
    rest_middle += model.rest_positions[i] / static_cast<double>(model.node_count());
  }
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    worst = std::max(worst, std::abs((state.positions[i] - middle).norm() -
                                     (model.rest_positions[i] - rest_middle).norm()));
  }
  return worst;
}

/// Plates at z = ±height close at a constant speed.
class Squeeze {
 public:
  Squeeze(const OrganModel& model, OrganDynamics& dynamics, double height)
      : model_(model), dynamics_(dynamics), height_(height), state_(rest_state(model)) {}

  void step(double h, double speed, double friction = 0) {
    const double margin = std::max(5e-3, 3 * speed * h);
    rows_.clear();
    for (std::uint32_t i = 0; i < model_.surface_node_count; ++i) {
      for (const int side : {1, -1}) {
        const double gap = height_ - side * state_.positions[i].z();
        if (gap > margin) continue;
        ContactRow row;
        row.nodes = {i, i, i};
        row.weights = Vec3(1, 0, 0);
        row.normal = Vec3(0, 0, side);
        row.gap = gap;
        row.friction = friction;
        row.probe_velocity = Vec3(0, 0, -side * speed);
        rows_.push_back(row);
      }
    }
    const StepReport report = dynamics_.step(h, rows_, state_);
    failed_ |= report.volume_skipped;
    height_ -= speed * h;
    impulse_ = 0;
    for (const ContactRow& row : rows_) impulse_ += row.normal_impulse / 2;
    force_ = impulse_ / h;
  }
  /// Closes to `height`, then waits `rest` [s]. @returns the mean force of the last tenth [N]
  double go_to(double height, double speed, double rest) {
    const double h = dynamics_.largest_step();
    const int strokes = std::max(1, static_cast<int>(std::ceil((height_ - height) / (speed * h))));
    const double wanted = (height_ - height) / (strokes * h);
    for (int k = 0; k < strokes; ++k) step(h, wanted);
    const int waits = static_cast<int>(std::ceil(rest / h)), last = std::max(1, waits / 10);
    double sum = 0;
    for (int k = 0; k < waits; ++k) {
      step(h, 0);
      if (k >= waits - last) sum += force_;
    }
    return sum / last;
  }
  double equatorial_radius() const {
    double radius = 0;
    for (std::size_t i = 0; i < model_.surface_node_count; ++i) {
      radius = std::max(radius, state_.positions[i].head<2>().norm());
    }
    return radius;
  }
  OrganState& state() { return state_; }
  double force() const { return force_; }
  bool failed() const { return failed_; }
  double deepest() const {
    double deepest = 0;
    for (std::size_t i = 0; i < model_.surface_node_count; ++i) {
      deepest = std::max(deepest, std::abs(state_.positions[i].z()) - height_);
    }
    return deepest;
  }

 private:
  const OrganModel& model_;
  OrganDynamics& dynamics_;
  double height_, force_ = 0, impulse_ = 0;
  OrganState state_;
  std::vector<ContactRow> rows_;
  bool failed_ = false;
};

}  // namespace palpate::deformation::testing
