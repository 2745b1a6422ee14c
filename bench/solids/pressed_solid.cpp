#include "bench/solids/pressed_solid.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "deformation/steppers/implicit_solid.h"
#include "modules/geometry/closest_points.h"
#include "modules/geometry/organ_shape.h"

namespace palpate::solids_bench {
namespace {

constexpr double kSpeed = 20e-3;         // of presses together [m/s]
constexpr double kContactMargin = 2e-3;  // rows for nodes nearer than this [m]
constexpr double kHoldTime = 0.1;        // between looks [s]
constexpr int kMaxHolds = 40;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

PressedSolid::PressedSolid(const scene::Organ& organ, const geometry::TetMesh& mesh,
                           std::vector<Press> presses, const MakeDynamics& make, double step)
    : model_(deformation::build_organ_model(organ, Vec3::Zero(), geometry::shape_of(mesh))),
      presses_(std::move(presses)),
      step_(step),
      dynamics_(make(model_)),
      state_(deformation::rest_state(model_)),
      normal_impulses_(presses_.size() * model_.triangles.size(), 0) {}

Rest PressedSolid::press_to(double depth) {
  while (depth_ < depth) advance_to(std::min(depth, depth_ + kSpeed * step_));
  Rest rest;
  rest.depth = depth;
  const int steps = static_cast<int>(std::ceil(kHoldTime / step_));
  const auto* solid = dynamic_cast<const deformation::ImplicitSolid*>(dynamics_.get());
  int holds = 0;
  for (; holds < kMaxHolds && !rest.settled; ++holds) {
    const double before = rest.force, start = now();
    for (int i = 0; i < steps; ++i) {
      advance_to(depth);
      if (solid != nullptr) rest.iterations += solid->iterations_used();
    }
    const double seconds = (now() - start) / steps;
    rest.seconds_per_step = holds == 0 ? seconds : std::min(rest.seconds_per_step, seconds);
    const auto each = forces();
    const auto [least, most] = std::minmax_element(each.begin(), each.end());
    rest.force = 0;
    for (const double force : each) rest.force += force / static_cast<double>(each.size());
    rest.settled = holds > 0 && std::abs(rest.force - before) <= 5e-4 * rest.force &&
                   *most - *least <= 2e-3 * rest.force;
  }
  rest.iterations /= holds * steps;
  rest.volume_ratio =
      geometry::enclosed_volume(state_.positions, model_.triangles) / model_.rest_volume;
  return rest;
}

void PressedSolid::advance_to(double depth) {
  rows_.clear();
  row_presses_.clear();
  row_keys_.clear();
  for (std::size_t p = 0; p < presses_.size(); ++p) {
    const std::size_t first = rows_.size();
    if (presses_[p].radius > 0) {
      touch_triangles(p);
    } else {
      touch_nodes(p);
    }
    for (std::size_t r = first; r < rows_.size(); ++r) {
      rows_[r].probe_velocity =
          presses_[p].share * (depth - depth_) / step_ * presses_[p].direction;
    }
  }
  std::fill(normal_impulses_.begin(), normal_impulses_.end(), 0);
  dynamics_->step(step_, rows_, state_);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    normal_impulses_[row_keys_[r]] = rows_[r].normal_impulse;
  }
  depth_ = depth;
}

/// A plate touches nodes.
void PressedSolid::touch_nodes(std::size_t press) {
  const Press& plate = presses_[press];
  const Vec3 point = plate.start + plate.share * depth_ * plate.direction;
  for (std::uint32_t i = 0; i < model_.surface_node_count; ++i) {
    add_row(press, i, {i, i, i}, Vec3::UnitX(), (point - state_.positions[i]), -plate.direction);
  }
}

/// A sphere touches triangles, each where it is nearest; a point that several share counts once.
void PressedSolid::touch_triangles(std::size_t press) {
  const Press& sphere = presses_[press];
  const Vec3 center = sphere.start + sphere.share * depth_ * sphere.direction;
  std::vector<Vec3> found;
  for (std::size_t t = 0; t < model_.triangles.size(); ++t) {
    const auto& nodes = model_.triangles[t];
    const auto& x = state_.positions;
    const auto near =
        geometry::closest_on_triangle(center, {x[nodes[0]], x[nodes[1]], x[nodes[2]]});
    const Vec3 way = center - near.point;
    if (way.norm() > sphere.radius + kContactMargin) continue;
    if (std::any_of(found.begin(), found.end(),
                    [&](const Vec3& p) { return (p - near.point).norm() < 1e-9; })) {
      continue;
    }
    found.push_back(near.point);
    add_row(press, t, nodes, near.weights, way - sphere.radius * way.normalized(),
            way.normalized());
  }
}

/// @param way  from the tissue's point to the press's [m]
void PressedSolid::add_row(std::size_t press, std::size_t key, const geometry::Triangle& nodes,
                           const Vec3& weights, const Vec3& way, const Vec3& normal) {
  const double gap = way.dot(normal);
  if (gap > kContactMargin) return;
  deformation::ContactRow row;
  row.nodes = nodes;
  row.weights = weights;
  row.normal = normal;
  row.gap = gap;
  row.normal_impulse = normal_impulses_[press * model_.triangles.size() + key];
  rows_.push_back(row);
  row_presses_.push_back(press);
  row_keys_.push_back(press * model_.triangles.size() + key);
}

/// Of the last step along the presses' directions.
std::vector<double> PressedSolid::forces() const {
  std::vector<double> forces(presses_.size(), 0);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const std::size_t p = row_presses_[r];
    forces[p] -= rows_[r].normal_impulse * rows_[r].normal.dot(presses_[p].direction) / step_;
  }
  return forces;
}

std::vector<Press> ball_plates(double radius) {
  return {{Vec3(0, 0, radius), Vec3(0, 0, -1), 0.5}, {Vec3(0, 0, -radius), Vec3(0, 0, 1), 0.5}};
}

std::vector<Press> sphere_over(double radius, double height) {
  return {{Vec3(0, 0, height + radius), Vec3(0, 0, -1), 1, radius}};
}

}  // namespace palpate::solids_bench
