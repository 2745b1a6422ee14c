// A scene whose keys are changed one by one, each change held to the schema as if the file said it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "modules/scene/scene_value.h"

namespace palpate::scene {

class SceneDocument {
 public:
  /// A key by its path, "organs[0].tissue.youngs_modulus_pa", and its value; nothing: left out.
  using Change = std::pair<std::string, SceneValue>;

  /// @throws SceneError as load_scene() and parse_scene() do
  explicit SceneDocument(const std::filesystem::path& file);
  SceneDocument(std::string text, std::filesystem::path file);

  const Scene& scene() const { return scene_; }

  /// All of them or, where the scene would not be acceptable, none. An entry one behind a list's
  /// last is added.
  /// @throws SceneError with the line of the key, or of what would hold it if the text has no such
  void change(std::span<const Change> changes);

  /// Of a key, or all of the scene for "". Keys at their defaults have values, too.
  /// @throws SceneError if there is none
  SceneValue value(const std::string& path) const;

 private:
  std::string text_;
  std::filesystem::path file_;
  std::vector<Change> changes_;  ///< since the text
  Scene scene_;
};

}  // namespace palpate::scene
