// Random probes and their ways: presses, cuts, jumps and squeezes.
#pragma once

#include "studies/fuzz/random_scene.h"
#include "studies/fuzz/random_stream.h"

namespace palpate::fuzz {

/// One to three, at the first organ.
void add_probes(RandomStream& random, RandomScene& scene);

}  // namespace palpate::fuzz
