#include "modules/scene/scene_file.h"

#include <algorithm>
#include <fstream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"

namespace palpate::scene {
namespace {

/// The comment lines a file begins with, as one line, to the end of the first sentence.
std::string first_sentence(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string text;
  for (std::string line; std::getline(stream, line) && line.starts_with("# ");) {
    text += (text.empty() ? "" : " ") + line.substr(2);
    if (const auto end = text.find(". "); end != std::string::npos) return text.substr(0, end + 1);
  }
  return text;
}

bool is_mesh(const std::filesystem::path& file) {
  const auto kind = file.extension();
  return kind == ".stl" || kind == ".STL" || kind == ".ply" || kind == ".obj" || kind == ".off";
}

}  // namespace

std::vector<ShippedScene> shipped_scenes() {
  std::vector<ShippedScene> scenes;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(data_folder() / "scenes", none)) {
    const auto& file = entry.path();
    if (file.extension() != ".yaml") continue;
    scenes.push_back({file.stem().string(), file, first_sentence(file)});
  }
  std::sort(scenes.begin(), scenes.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return scenes;
}

std::filesystem::path scene_file(const std::filesystem::path& named) {
  std::error_code none;
  if (std::filesystem::is_regular_file(named, none) && is_mesh(named)) {
    throw InputError(named.string() + ": a mesh, not a scene: palpate new makes a scene of it");
  }
  const bool exists = std::filesystem::exists(named, none);
  if (named.empty() || (exists && !std::filesystem::is_directory(named, none))) return named;
  for (const auto& scene : shipped_scenes()) {
    if (named == scene.name || named == scene.file.filename()) return scene.file;
  }
  if (exists) return named;  // who reads it says that it is a folder
  throw InputError(named.string() +
                   ": no such file, and no shipped scene has that name (palpate list scenes)");
}

bool is_shipped(const std::filesystem::path& file) {
  std::error_code none;
  return std::filesystem::equivalent(file.parent_path(), data_folder() / "scenes", none);
}

}  // namespace palpate::scene
