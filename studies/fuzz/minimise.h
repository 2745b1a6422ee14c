// Makes a failing scene as simple as it can be while it still fails.
#pragma once

#include <functional>

#include "studies/fuzz/random_scene.h"

namespace palpate::fuzz {

/// Drops probes, moves, organs, regions, filling and faults, takes smaller meshes, half the time
/// and defaults, one after the other, until nothing more can be taken away.
/// @param fails  whether a scene shows the failure; true for `scene`
RandomScene minimised(RandomScene scene, const std::function<bool(const RandomScene&)>& fails);

}  // namespace palpate::fuzz
