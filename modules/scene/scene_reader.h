// Strict YAML → Scene. Unknown and missing keys, wrong types, units and ranges are errors.
#pragma once

#include <string>
#include <string_view>

#include "modules/scene/scene.h"

namespace palpate::scene {

/// @throws InputError "file:line: key 'organs[0].tissue.youngs_modulus_pa' = '-3': must be …".
/// All files the scene names are resolved against its folder and must exist.
Scene load_scene(const std::filesystem::path& file);

/// The same from text; `file` is used for messages and for resolving relative paths.
Scene parse_scene(std::string_view text, const std::filesystem::path& file);

/// An emulated device from the keys that a scene's `emulated` has, in the place of a probe that a
/// driver moves: it starts there unless start_m or rotation_xyzw say otherwise.
/// @param source  what messages call the text
EmulatedDevice parse_emulated_device(std::string_view text, const std::string& source,
                                     const TopicDevice& place);

/// YAML with every default written out; parse_scene() of it gives the same scene.
std::string resolved_text(const Scene& scene);

/// 16 hex digits over the resolved text and the bytes of every file it names, of whose names only
/// the extensions count, as the scene's own does not: equal iff the physics is the same, wherever
/// the files lie and whatever they are called.
std::string scene_digest(const Scene& scene);

}  // namespace palpate::scene
