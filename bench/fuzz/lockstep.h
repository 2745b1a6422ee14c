// A random scene through the libraries of all processes, one after the other, every message looked
// at as the processes' codecs do, some spoilt on the way.
#pragma once

#include "bench/fuzz/outcome.h"
#include "bench/fuzz/random_scene.h"
#include "bench/fuzz/shape_store.h"

namespace palpate::fuzz {

/// Runs for the scene's duration, or until it has cost as much as a few milliseconds of a small
/// mesh (counted in nodes and steps, not by a clock). A failure ends it.
Outcome run_lockstep(const RandomScene& scene, const ShapeStore& shapes);

/// The same in a process of its own: a crash or a hang is a failure of the scene, not ours.
Outcome run_apart(const RandomScene& scene, const ShapeStore& shapes);

}  // namespace palpate::fuzz
