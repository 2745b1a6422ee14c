// Truths that no reference has. At rest: equilibria of quadratic elements (deformation/elements),
// on meshes finer than a model can step and refined under what touches, independent of step and
// damping. In motion: the model quadratic_elements in small steps.
#pragma once

#include "studies/chart/cases.h"

namespace palpate::accuracy {

/// Meshes of a truth: the last is the truth, the one before says how far it may be off.
inline constexpr int kTruthLevels = 2;

// Each answers what Sample::force, shape and profile are in the case of its name.
Measurement press_liver(int level, const Source& source, const KeepGoing& keep_going);
Measurement press_stomach(int level, const Source& source, const KeepGoing& keep_going);
Measurement press_block(int level, const Source& source, const KeepGoing& keep_going);
/// The accurate rung itself, in steps that backward Euler's damping no longer shows in.
Measurement squeeze_in_small_steps(int level, const Source& source, const KeepGoing& keep_going);
Measurement bend_beam(int level, const Source& source, const KeepGoing& keep_going);

}  // namespace palpate::accuracy
