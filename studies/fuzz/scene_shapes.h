// What a random scene's organs and probes are made of.
#pragma once

#include "palpate/session/in_process.h"
#include "studies/fuzz/random_scene.h"
#include "studies/fuzz/shape_store.h"

namespace palpate::fuzz {

/// Organs in W [m].
session::Assets assets_of(const RandomScene& scene, const ShapeStore& store);

}  // namespace palpate::fuzz
