// One way to advance an organ: how its contents are modelled, and how time is stepped.
#pragma once

#include <memory>
#include <span>

#include "deformation/contact_solve.h"
#include "deformation/organ_model.h"

namespace palpate::deformation {

/// What one step did beyond stepping.
struct StepReport {
  bool volume_skipped = false;  ///< gᵀM⁻¹g vanished: the volume was not corrected
};

/// Keeps its buffers between steps, so that a step does not allocate.
class OrganDynamics {
 public:
  virtual ~OrganDynamics() = default;

  /// The largest step it is given, its own safety factor included [s].
  virtual double largest_step() const = 0;

  /// Advances the state by h [s], 0 < h ≤ largest_step(), to the volume state.target_volume = V* of
  /// the step's end, and leaves the pressure of the contents. Contact rows hold their gaps at the
  /// step's start; they keep the impulses found.
  virtual StepReport step(double h, std::span<ContactRow> rows, OrganState& state) = 0;
};

/// What `organ` asks for. Automatic: what is cheaper for this model.
/// @param model  outlives the dynamics
/// @throws InputError if the integrator does not go with the organ's model
std::unique_ptr<OrganDynamics> make_dynamics(const scene::Organ& organ, const OrganModel& model);

}  // namespace palpate::deformation
