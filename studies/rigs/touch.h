// Planes and spheres that press the nodes of one organ, with steps of any size: no world, no
// collision search, no guards, no sub-steps.
#pragma once

#include <span>
#include <vector>

#include "deformation/steppers/organ_dynamics.h"

namespace palpate::rigs {

/// A thing that touches nodes, without friction.
struct Obstacle {
  Vec3 position = Vec3::Zero();  ///< centre of a sphere, a point of a plane, in W [m]
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
  double radius = 0;             ///< of a sphere, > 0 [m]; 0: a plane
  Vec3 facing = Vec3::UnitZ();   ///< of a plane: unit, towards its free side
};

/// One contact row per near node and obstacle, started from the impulses of the step before.
class Touch {
 public:
  /// @param nodes  the organ's surface nodes, which come first
  explicit Touch(std::size_t nodes) : nodes_(nodes) {}

  /// @param obstacles  where they are as the step begins, as many in every call
  /// @param near  nodes whose gap is less get a row [m]
  void step(std::span<const Obstacle> obstacles, double near, double h,
            deformation::OrganDynamics& dynamics, deformation::OrganState& state);

  /// Of the last step, between an obstacle and a node [N·s].
  double impulse(std::size_t obstacle, std::size_t node) const {
    return impulses_[obstacle * nodes_ + node];
  }

 private:
  std::size_t nodes_;
  std::vector<deformation::ContactRow> rows_;
  std::vector<std::size_t> slots_;  ///< of each row, into impulses_
  std::vector<double> impulses_;    ///< [obstacle · nodes + node] [N·s]
};

}  // namespace palpate::rigs
