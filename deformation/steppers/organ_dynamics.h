// One way to advance an organ: how its contents are modelled, and how time is stepped.
#pragma once

#include <memory>
#include <span>

#include "deformation/contact/contact_solve.h"
#include "deformation/model/organ_model.h"
#include "modules/core/parallel.h"

namespace palpate::deformation {

/// What one step did beyond stepping.
struct StepReport {
  bool volume_skipped = false;   ///< gᵀM⁻¹g vanished: the volume was not corrected
  bool pressure_capped = false;  ///< state.pressure_limit was pushed with; the volume is not V*
};

/// Keeps its large buffers between steps; only a solve for contacts takes memory for their number.
class OrganDynamics {
 public:
  virtual ~OrganDynamics() = default;

  /// The largest step it is given, its own safety factor included [s].
  virtual double largest_step() const = 0;

  /// Advances the state by h [s], 0 < h ≤ largest_step(), to the volume state.target_volume = V* of
  /// the step's end, and leaves the pressure of the contents. Contact rows hold their gaps at the
  /// step's start; they keep the impulses found.
  virtual StepReport step(double h, std::span<ContactRow> rows, OrganState& state) = 0;

  /// Stored in springs or tissue [J].
  virtual double elastic_energy(const OrganState& state) = 0;
};

/// How an organ's springs are stepped, and what that was decided by.
struct IntegratorChoice {
  scene::Integrator integrator = scene::Integrator::kSymplecticEuler;  ///< not kAutomatic
  /// Passes over all springs per simulated second that each would need.
  double symplectic_passes = 0, backward_passes = 0;
};

/// Whether a model steps by a method of its own, so that no integrator can be chosen.
bool has_own_steps(scene::Model model);

/// What `organ` asks for. Automatic is backward Euler where symplectic Euler needs more than twice
/// the passes over the springs, else symplectic Euler, which neither damps nor lags.
/// @param period  of an advance, which is divided into equal steps [s]
IntegratorChoice choose_integrator(const scene::Organ& organ, const OrganModel& model,
                                   double period);

/// The organ's model with the integrator chosen.
/// @param model   outlives the dynamics
/// @param period  of an advance [s]
/// @param runner  outlives the dynamics; none: the calling thread alone. The bits are the same
/// @throws InputError if the integrator does not go with the organ's model
std::unique_ptr<OrganDynamics> make_dynamics(const scene::Organ& organ, const OrganModel& model,
                                             double period, ChunkRunner* runner = nullptr);

}  // namespace palpate::deformation
