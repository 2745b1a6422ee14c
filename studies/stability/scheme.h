// The models and integrators of the atlas, and the ball they are tried on.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "studies/rigs/squeezed_ball.h"
#include "studies/rigs/test_body.h"
#include "studies/stability/predicted_step.h"
#include "studies/stability/verdict.h"

namespace palpate::stability {

using rigs::kBallRadius;
using rigs::TestBody;

inline constexpr double kYoungsModulus = 10e3;  // where it is not what varies [Pa]

struct Scheme {
  std::string name;
  std::string model;
  scene::Integrator integrator;
  bool quick;         ///< part of --quick
  bool keeps_volume;  ///< to some per mille, if all is well
};

/// Every model, and both integrators of those that have a choice: "_backward" follows the word.
const std::vector<Scheme>& schemes();
/// @pre there is one of that name
const Scheme& scheme_named(const std::string& name);

/// The scheme's organ: a hollow ball (wall 3 mm) of springs, or a solid one (ν = 0.45), free and
/// without damping.
scene::Organ organ_of(const Scheme& scheme, double youngs_modulus);

/// The ball's mesh, 162 nodes on the surface; filled with tetrahedra at the first call that asks.
/// Quadratic models factorise matrices, or look for modes: 42 nodes for modal, 12 for
/// quadratic_elements.
class Shapes {
 public:
  /// @throws InputError if the ball cannot be filled (Gmsh is missing)
  const geometry::OrganShape& shape_for(const Scheme& scheme);

 private:
  std::optional<geometry::OrganShape> surface_, solid_, modal_, quadratic_;
};

/// The ball with one triangle more and more of a sliver: a node at 1/ratio of an edge's length
/// beside that edge's middle, and another in the middle of the flat triangle that makes, whose
/// mass is as small as its triangles are flat.
/// @param ratio  ≥ 4
geometry::OrganShape ball_with_sliver(double ratio);

struct Prediction {
  double value = std::numeric_limits<double>::quiet_NaN();  ///< of the frontier, by theory
  double given = std::numeric_limits<double>::quiet_NaN();  ///< largest_step(), or none
  bool exact = false;  ///< the theory is one of this model, not of its springs alone
};

/// 2/ω_max with damping, for explicit steps, as the springs are at the body's positions.
Prediction predict(const Scheme& scheme, TestBody& body);

}  // namespace palpate::stability
