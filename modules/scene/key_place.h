// Where a scene's file has a key: for what is wrong with it that only its meshes, or its physics,
// show.
#pragma once

#include <string>

#include "modules/scene/scene.h"
#include "modules/scene/scene_error.h"

namespace palpate::scene {

/// "scene.yaml:12: PROBLEM", the line being that of the key, or of what would hold it; none where
/// the file is not there, or cannot be read; a scene without one is called "scene".
/// @param key  its path, "organs[0].fixed", or "organs[liver].fixed"
SceneError error_at(const Scene& scene, const std::string& key, const std::string& problem);

/// What `job` does with one organ; what is wrong with that is told with the organ's line, which its
/// name finds: the scene may hold fewer organs than the file.
/// @throws as `job`, of InputErrors SceneError
template <class Job>
auto with_organ(const Scene& scene, std::size_t organ, Job&& job) {
  try {
    return job(scene.organs.at(organ));
  } catch (const SceneError&) {
    throw;
  } catch (const InputError& error) {
    throw error_at(scene, "organs[" + scene.organs[organ].name + "]", error.what());
  }
}

}  // namespace palpate::scene
