// Reference solutions that no reference has. At rest: equilibria of quadratic elements
// (deformation/elements), on meshes finer than a model can step and refined under what touches,
// independent of step and damping; of organs and the slide on two nested ones, extrapolated, with a
// bar (studies/truth). In motion: the model quadratic_elements in small steps.
#pragma once

#include "studies/chart/cases.h"

namespace palpate::chart {

/// Meshes of a reference solution: the last is it, the one before says how far it may be off.
inline constexpr int kReferenceLevels = 2;
/// Random places of an organ, each with a truth of its own (studies/truth).
inline constexpr int kPlaces = 22;

// Each answers what Sample::force, shape and profile are in the case of its name.
Measurement truth_on_liver(int place, const KeepGoing& keep_going);
Measurement truth_on_stomach(int place, const KeepGoing& keep_going);
Measurement small_truth_on_liver(int place, const KeepGoing& keep_going);
Measurement small_truth_on_stomach(int place, const KeepGoing& keep_going);
/// Of the sliding block, at its middle and on its way.
Measurement truth_of_slide(int part, const KeepGoing& keep_going);
Measurement press_block(int level, const KeepGoing& keep_going);
/// The most accurate model itself, in steps that backward Euler's damping no longer shows in.
Measurement squeeze_in_small_steps(int level, const KeepGoing& keep_going);
Measurement bend_beam(int level, const KeepGoing& keep_going);

}  // namespace palpate::chart
