// All deformation models, one row each: the only place that knows how a scene's word becomes a
// stepper. What a scene may say of a model is in modules/scene/models.h, in the same order.
#pragma once

#include <cstdint>
#include <limits>
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

/// How well a model keeps V at V* beside what its material does for it.
enum class VolumeKeeping : std::uint8_t {
  kNone,
  kAbout,   ///< by forces, or late
  kExactly  ///< in every step, to its linearisation at least
};

struct ModelRow {
  const char* word = "";  ///< as in scene::model_formats()
  VolumeKeeping volume = VolumeKeeping::kNone;
  bool has_volume_constraint = false;  ///< answers an error of the volume with any impulse it takes
  /// Where nothing holds or touches it; by backward Euler linear momentum alone is conserved.
  bool conserves_momentum = true, conserves_angular_momentum = true;
  /// elastic_energy() is all it stores and its contacts' impulses all it is given. Not so where the
  /// contents store energy, or nodes are moved by no force.
  bool knows_energy = true;
  /// What it is off by under a probe is the size of its mesh, which estimated_force_error() tells:
  /// it does not lock, has no modes left out and solves its steps.
  bool tells_mesh_error = false;
  /// The matrix of a touched patch does not tell what its steps answer a press by: a law is pressed
  /// on copies (pressed_copy.h) every so many periods. 0: the matrix tells.
  int press_every = 0;
  double step_cost = 1;  ///< of a node's step, over one of springs; measured, to one digit
  /// κ/μ it computes with at most, whatever Poisson's ratio it is asked for.
  double largest_bulk_over_shear = std::numeric_limits<double>::infinity();
  bool is_charted = true;  ///< in `palpate chart`; else compared in `palpate volume-methods` alone
  /// Whether `palpate plan` tries it for such contents.
  bool stands_for_fluid = false, stands_for_solid = false;
  std::unique_ptr<OrganDynamics> (*make)(const ModelParts&) = nullptr;
};

std::span<const ModelRow> model_rows();
const ModelRow& row_of(std::string_view model);

/// Poisson's ratio that a solid computes with; that of the scene, unless its model caps it.
double computed_poisson_ratio(const scene::Organ& organ);

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
