// A random scene as a session in one process, some of its messages corrupted, lost, delayed or
// repeated on their way.
#pragma once

#include "deformation/simulated_organ.h"
#include "studies/fuzz/outcome.h"
#include "studies/fuzz/random_scene.h"
#include "studies/fuzz/shape_store.h"
#include "studies/report/progress.h"

namespace palpate::fuzz {

/// Runs for the scene's duration, or until it has cost as much as a few milliseconds of a small
/// mesh (counted in nodes and steps, not by a clock). A failure ends it.
/// @param guarding  off: also fails if an organ is found shaking, grown or turned inside out at
///                  the end (organ_watch.h)
Outcome run_lockstep(const RandomScene& scene, const ShapeStore& shapes,
                     deformation::Guarding guarding = deformation::Guarding::kOn);

/// The same in a process of its own: a crash or a hang is a failure of the scene, not ours.
/// @param keep_going  asked meanwhile, several times a second; what it throws ends that process
Outcome run_apart(const RandomScene& scene, const ShapeStore& shapes,
                  const report::KeepGoing& keep_going = {},
                  deformation::Guarding guarding = deformation::Guarding::kOn);

/// And, where a guard of the state acted, once more without them.
Outcome run_and_compare(const RandomScene& scene, const ShapeStore& shapes,
                        const report::KeepGoing& keep_going = {});

}  // namespace palpate::fuzz
