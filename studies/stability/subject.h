// The models and integrators of the atlas, and the ball they are tried on.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "deformation/steppers/organ_dynamics.h"
#include "studies/stability/predicted_step.h"
#include "studies/stability/verdict.h"

namespace palpate::stability {

inline constexpr double kRadius = 0.05;         // of the ball [m]
inline constexpr double kYoungsModulus = 10e3;  // where it is not what varies [Pa]

struct Subject {
  const char* name;
  scene::Model model;
  scene::Integrator integrator;
  bool quick;         ///< part of --quick
  bool keeps_volume;  ///< to some per mille, if all is well
};

/// Every model, and both integrators of those that have a choice.
const std::vector<Subject>& subjects();
/// @pre there is one of that name
const Subject& subject_named(const std::string& name);

/// The subject's organ: a hollow ball (wall 3 mm) of springs, or a solid one (ν = 0.45), free and
/// without damping.
scene::Organ organ_of(const Subject& subject, double youngs_modulus);

/// The ball's mesh, 162 nodes on the surface; filled with tetrahedra at the first call that asks.
/// Quadratic models factorize matrices, or look for modes: 42 nodes for modal, 12 for
/// quadratic_elements.
class Shapes {
 public:
  /// @throws InputError if the ball cannot be filled (Gmsh is missing)
  const geometry::OrganShape& shape_for(const Subject& subject);

 private:
  std::optional<geometry::OrganShape> surface_, solid_, modal_, quadratic_;
};

/// The ball with one triangle more and more of a sliver: a node at 1/ratio of an edge's length
/// beside that edge's middle, and another in the middle of the flat triangle that makes, whose
/// mass is as small as its triangles are flat.
/// @param ratio  ≥ 4
geometry::OrganShape ball_with_sliver(double ratio);

/// An organ that is stepped with any h.
class Specimen {
 public:
  /// @param organ  as organ_of() gives it, its damping perhaps changed
  Specimen(const scene::Organ& organ, const geometry::OrganShape& shape);

  const deformation::OrganModel& model() const { return *model_; }
  deformation::OrganDynamics& dynamics() { return *dynamics_; }
  deformation::OrganState& state() { return state_; }
  const deformation::OrganState& state() const { return state_; }
  double mass() const;  ///< [kg]

 private:
  std::unique_ptr<const deformation::OrganModel> model_;
  std::unique_ptr<deformation::OrganDynamics> dynamics_;
  deformation::OrganState state_;
};

struct Prediction {
  double value = std::numeric_limits<double>::quiet_NaN();  ///< of the frontier, by theory
  double given = std::numeric_limits<double>::quiet_NaN();  ///< largest_step(), or none
  bool exact = false;  ///< the theory is one of this model, not of its springs alone
};

/// 2/ω_max with damping, for explicit steps, as the springs are at the specimen's positions.
Prediction predict(const Subject& subject, Specimen& specimen);

}  // namespace palpate::stability
