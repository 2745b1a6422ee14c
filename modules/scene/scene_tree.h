// A scene's text as a tree, and the scene that a tree is: the two halves of parse_scene(), for who
// changes the tree between them (scene_document.h).
#pragma once

#include <string_view>

#include "modules/scene/yaml_value.h"

namespace palpate::scene {

/// @throws SceneError for what is not one YAML document, or too long
YAML::Node parse_yaml(std::string_view text, const Source& source);

/// @throws SceneError as parse_scene()
Scene scene_from(const YAML::Node& tree, const std::filesystem::path& file);

}  // namespace palpate::scene
