// Reference solutions that no reference has. At rest: equilibria of quadratic elements
// (deformation/elements), on meshes finer than a model can step and refined under what touches,
// independent of step and damping. In motion: the model quadratic_elements in small steps.
#pragma once

#include "studies/chart/cases.h"

namespace palpate::chart {

/// Meshes of a reference solution: the last is it, the one before says how far it may be off.
inline constexpr int kReferenceLevels = 2;

// Each answers what Sample::force, shape and profile are in the case of its name.
Measurement press_liver(int level, const KeepGoing& keep_going);
Measurement press_stomach(int level, const KeepGoing& keep_going);
Measurement press_block(int level, const KeepGoing& keep_going);
/// The most accurate model itself, in steps that backward Euler's damping no longer shows in.
Measurement squeeze_in_small_steps(int level, const KeepGoing& keep_going);
Measurement bend_beam(int level, const KeepGoing& keep_going);

}  // namespace palpate::chart
