// One step of an organ by semi-implicit (symplectic) Euler, contacts and volume inside.
#pragma once

#include <span>
#include <vector>

#include "deformation/contact_solve.h"
#include "deformation/organ_model.h"

namespace palpate::deformation {

/// Buffers kept between steps so that a step does not allocate.
struct StepBuffers {
  std::vector<Vec3> forces;
  VolumeGradient volume;
};

/// Advances the state by h [s]. Stable for h below stable_step_bound(). Contact rows must hold
/// their gaps at the current positions.
ContactSolveReport symplectic_euler_step(const OrganModel& model, double h,
                                         std::span<ContactRow> rows, OrganState& state,
                                         StepBuffers& buffers);

}  // namespace palpate::deformation
