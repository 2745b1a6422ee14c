// Keys of a scene changed from a command line: `--set organs[0].tissue.youngs_modulus_pa=8e3`.
#pragma once

#include <string>
#include <vector>

#include "modules/scene/scene_document.h"

namespace palpate::scene {

/// "path=value", the value written as in a scene file; nothing behind the sign: the default.
/// @throws InputError naming the setting if it is not that
SceneDocument::Change change_from(const std::string& setting);

/// The scene of a file with these settings in the place of what it says, judged together.
/// @throws InputError as load_scene(), change_from() and SceneDocument::change() do; where a
///         setting is wrong it names the setting, not a line of the file
Scene load_scene_with(const std::filesystem::path& file, const std::vector<std::string>& settings);

}  // namespace palpate::scene
