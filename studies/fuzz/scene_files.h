// A random scene as files that `palpate run` and `palpate check` take.
#pragma once

#include <filesystem>

#include "studies/fuzz/random_scene.h"

namespace palpate::fuzz {

/// Writes scene.yaml and its meshes into `folder`, made if need be. Faults are comments there.
/// @returns the scene file
std::filesystem::path write_scene(RandomScene scene, const ShapeStore& shapes,
                                  const std::filesystem::path& folder);

}  // namespace palpate::fuzz
