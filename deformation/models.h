// All deformation models, one row each: the only place that knows how a scene's word becomes a
// stepper. What a scene may say of a model is in modules/scene/models.h. Nothing depends on the
// order of the rows.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "deformation/model/organ_model.h"
#include "deformation/steppers/organ_dynamics.h"
#include "modules/core/parallel.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

/// What a factory may use to build a stepper.
struct ModelParts {
  const scene::Organ& organ;
  const OrganModel& model;
  int iterations = 0;  ///< the scene's, or the model's own
  scene::Integrator integrator = scene::Integrator::kSymplecticEuler;  ///< chosen
  ChunkRunner* runner = nullptr;
};

struct ModelRow {
  const char* word = "";               ///< as in scene::model_formats()
  bool conserves_volume = false;       ///< V = V* of every step, to its linearisation at least
  bool conserves_momentum = true;      ///< linear, where nothing holds or touches it
  bool has_volume_constraint = false;  ///< answers an error of the volume with any impulse it takes
  /// elastic_energy() is all it stores and its contacts' impulses all it is given. Not so where the
  /// contents store energy, or nodes are moved by no force.
  bool knows_energy = true;
  std::unique_ptr<OrganDynamics> (*make)(const ModelParts&) = nullptr;
};

std::span<const ModelRow> model_rows();
const ModelRow& row_of(std::string_view model);

/// How an organ's springs are stepped, and what that was decided by.
struct IntegratorChoice {
  scene::Integrator integrator = scene::Integrator::kSymplecticEuler;  ///< not kAutomatic
  /// Passes over all springs per simulated second that each would need.
  double symplectic_passes = 0, backward_passes = 0;
};

/// What `organ` asks for, where its model leaves the choice. Automatic is backward Euler where
/// symplectic Euler needs more than twice the passes over the springs, else symplectic Euler, which
/// neither damps nor lags.
/// @param period  of an advance, which is divided into equal steps [s]
IntegratorChoice choose_integrator(const scene::Organ& organ, const OrganModel& model,
                                   double period);

/// The organ's model with the integrator chosen.
/// @param model   outlives the dynamics
/// @param period  of an advance [s]
/// @param runner  outlives the dynamics; none: the calling thread alone. The bits are the same
/// @throws InputError if integrator or springs do not go with the organ's model
std::unique_ptr<OrganDynamics> make_dynamics(const scene::Organ& organ, const OrganModel& model,
                                             double period, ChunkRunner* runner = nullptr);

}  // namespace palpate::deformation
