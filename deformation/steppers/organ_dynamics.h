// One way to advance an organ: how its contents are modelled, and how time is stepped.
#pragma once

#include <Eigen/Core>
#include <span>

#include "deformation/contact/compliance_row.h"
#include "deformation/contact/contact_solve.h"
#include "deformation/elements/step_matrix.h"
#include "deformation/model/organ_state.h"
#include "deformation/model/patch.h"

namespace palpate::deformation {

/// Conjugate gradients of a step end when what they could still change is below this [m/s], as a
/// mean weighted by mass.
inline constexpr double kNegligibleVelocity = 1e-7;

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

  /// Whether the elastic forces of a step are those at its end, else at its start.
  virtual bool is_implicit() const { return true; }

  /// Of a solid: adds the elastic stiffness of the patch as it was in the last step, all other
  /// nodes held, to the lower triangle of `sum` [N/m]. A model that has none to tell adds none.
  virtual void add_stiffness(const Patch& /*patch*/, Eigen::MatrixXf& /*sum*/) const {}

  /// What the last step solved with, of a solid that keeps it; else none.
  virtual StepMatrix step_matrix() const { return {}; }

  /// Of a solid that keeps a step_matrix(): makes it, and what add_stiffness() tells, those of a
  /// step to come from this state, crushed tissue in it like any other, until a step is made.
  virtual void foresee(const OrganState& /*state*/) {}

  /// C A⁻¹ Cᵀ of rows on the organ (contact/patch_compliance.h) [m/N], of a model that knows it
  /// better than from a patch of nodes; empty: it does not.
  virtual Eigen::MatrixXd compliance(std::span<const ComplianceRow> /*rows*/,
                                     const PeriodSteps& /*steps*/) const {
    return {};
  }

  /// V, g and gᵀM⁻¹g at these positions, as evaluate_volume() finds them (volume_gradient.h), of
  /// a stepper that has faster means; null: it has none. Valid until the next call or step.
  virtual const VolumeGradient* volume_at(const std::vector<Vec3>& /*positions*/) {
    return nullptr;
  }

  /// Stored in springs or tissue [J].
  virtual double elastic_energy(const OrganState& state) = 0;

  /// Stored in the contents beside that, where the model has such an energy [J].
  virtual double stored_energy(const OrganState& /*state*/) const { return 0; }
};

}  // namespace palpate::deformation
