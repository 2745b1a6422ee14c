#include "studies/rigs/squeezed_ball.h"

#include <algorithm>
#include <cmath>

#include "deformation/model/organ_model.h"
#include "modules/geometry/primitives.h"
#include "modules/geometry/tools/gmsh_tool.h"

namespace palpate::rigs {

scene::Organ ball_organ() {
  scene::Organ organ;
  organ.name = "ball";
  organ.tissue.youngs_modulus = 10e3;
  organ.tissue.wall_thickness = 3e-3;
  return organ;
}

geometry::OrganShape filled_ball(int levels) {
  const auto surface = geometry::make_ball(kBallRadius, levels);
  return geometry::shape_of(geometry::fill_surface(surface, geometry::mean_edge_length(surface)));
}

Pose plate_pose(double height, bool facing_up) {
  Pose pose;
  pose.position = Vec3(0, 0, height);
  if (!facing_up) pose.rotation = Quat(0, 1, 0, 0);
  return pose;
}

std::vector<Pose> add_plates(scene::Scene& scene) {
  for (const char* name : {"upper_plate", "lower_plate"}) {
    scene.probes.push_back({name, scene::PlaneShape{}, 0.0, scene::ScriptedDevice{}});
  }
  return {plate_pose(kBallRadius, false), plate_pose(-kBallRadius, true)};
}

double minimum_jerk(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (10 + t * (6 * t - 15));
}

double equatorial_radius(const std::vector<geometry::Triangle>& triangles,
                         const std::function<Vec3(std::size_t)>& position) {
  double sum = 0;
  int crossings = 0;
  for (const auto& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = position(triangle[k]), b = position(triangle[(k + 1) % 3]);
      if ((a.z() < 0) == (b.z() < 0)) continue;
      const Vec3 crossing = a + a.z() / (a.z() - b.z()) * (b - a);
      sum += std::hypot(crossing.x(), crossing.y());
      ++crossings;
    }
  }
  return sum / crossings;
}

double Plates::contact_area(const deformation::OrganState& state) const {
  deformation::VolumeGradient volume;
  deformation::evaluate_volume(model_, state.positions, volume);
  double area = 0;
  for (std::size_t i = 0; i < model_.surface_node_count; ++i) {
    if (touch_.impulse(0, i) > 0) area += volume.gradient[i].z();
  }
  return area;
}

void Plates::step(deformation::OrganDynamics& dynamics, double h, double new_height, double near,
                  deformation::OrganState& state) {
  const Vec3 position = height_ * Vec3::UnitZ();
  const Vec3 velocity = (new_height - height_) / h * Vec3::UnitZ();
  const std::array<Obstacle, 2> plates{
      {{position, velocity, 0, -Vec3::UnitZ()}, {-position, -velocity, 0, Vec3::UnitZ()}}};
  touch_.step(plates, near, h, dynamics, state);
  height_ = new_height;
  forces_ = {};
  for (std::size_t plate = 0; plate < 2; ++plate) {
    for (std::size_t i = 0; i < model_.surface_node_count; ++i) {
      forces_[plate] += touch_.impulse(plate, i) / h;
    }
  }
}

}  // namespace palpate::rigs
