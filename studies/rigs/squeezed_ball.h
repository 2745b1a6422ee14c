// A ball of 5 cm radius about the origin between two frictionless plates at z = ±height.
#pragma once

#include <array>
#include <functional>

#include "deformation/world.h"
#include "modules/geometry/organ_shape.h"
#include "studies/rigs/touch.h"

namespace palpate::rigs {

inline constexpr double kBallRadius = 0.05;  ///< [m]

/// Hollow: E 10 kPa, wall 3 mm.
scene::Organ ball_organ();

/// The ball of geometry::make_ball(), filled with tetrahedra as large as its triangles.
/// @throws InputError if it cannot be filled (Gmsh is missing)
geometry::OrganShape filled_ball(int levels);

/// Adds the plates as probes, the upper one first, without friction. @returns their poses, touching
std::vector<Pose> add_plates(scene::Scene& scene);

/// A plane, solid on the side that `facing_up` (±z) does not point to.
Pose plate_pose(double height, bool facing_up);

/// Share of a way done at the share `t` of its time, at rest at both ends; `t` may lie outside
/// [0, 1].
double minimum_jerk(double t);

/// Over all points where mesh edges cross z = 0, the mean distance from the z axis [m].
/// @param position  of a node, now [m]
double equatorial_radius(const std::vector<geometry::Triangle>& triangles,
                         const std::function<Vec3(std::size_t)>& position);

/// The two plates without a world: the organ's stepper is given a contact row per near node.
class Plates {
 public:
  Plates(const deformation::OrganModel& model, double height)
      : model_(model), height_(height), touch_(model.surface_node_count) {}

  double height() const { return height_; }
  /// Of a plate, in the last step [N]; 0: the upper, 1: the lower.
  double force(std::size_t plate = 0) const { return forces_[plate]; }
  /// Σ (∂V/∂x)_z of the nodes the upper plate held in the last step: its contact area [m²].
  double contact_area(const deformation::OrganState& state) const;

  /// @param near  nodes whose gap is less may touch within the step [m]
  void step(deformation::OrganDynamics& dynamics, double h, double new_height, double near,
            deformation::OrganState& state);
  /// Nodes as near as a tenth of the height.
  void step(deformation::OrganDynamics& dynamics, double h, double new_height,
            deformation::OrganState& state) {
    step(dynamics, h, new_height, 0.1 * height_, state);
  }

 private:
  const deformation::OrganModel& model_;
  double height_;
  std::array<double, 2> forces_{};
  Touch touch_;
};

}  // namespace palpate::rigs
