#include "modules/scene/placed_files.h"

#include <yaml-cpp/yaml.h>

#include <set>

#include "modules/scene/scene_tree.h"
#include "modules/scene/value_text.h"

namespace palpate::scene {
namespace {

constexpr const char* kKey = "file";
/// An anchor may hold itself: no file of a scene is named as deep.
constexpr int kDeepestFile = 16;

void collect_files(const YAML::Node& node, int depth, std::vector<std::filesystem::path>& files) {
  if (depth > kDeepestFile) return;
  if (node.IsSequence()) {
    for (const auto& entry : node) collect_files(entry, depth + 1, files);
  }
  if (!node.IsMap()) return;
  for (const auto& entry : node) {
    const bool names = entry.first.IsScalar() && entry.first.Scalar() == kKey;
    if (names && entry.second.IsScalar()) files.emplace_back(entry.second.Scalar());
    collect_files(entry.second, depth + 1, files);
  }
}

/// As the writer puts it: a line's end.
std::string naming(const std::filesystem::path& file) {
  return std::string(kKey) + ": " + quoted_text(file.string()) + "\n";
}

}  // namespace

std::vector<std::filesystem::path> files_named(const std::string& resolved_text) {
  std::vector<std::filesystem::path> files;
  collect_files(parse_yaml(resolved_text, {"scene", {}}), 0, files);
  return files;
}

std::vector<std::string> probe_names(const std::string& resolved_text) {
  std::vector<std::string> names;
  const YAML::Node scene = parse_yaml(resolved_text, {"scene", {}});
  const YAML::Node probes = scene.IsMap() ? scene["probes"] : YAML::Node();
  for (const auto& probe : probes) {
    const YAML::Node name = probe.IsMap() ? probe["name"] : YAML::Node();
    names.push_back(name && name.IsScalar() ? name.Scalar() : "");
  }
  return names;
}

std::string with_files(
    const std::string& resolved_text,
    const std::function<std::filesystem::path(const std::filesystem::path&)>& place) {
  const std::vector<std::filesystem::path> files = files_named(resolved_text);
  std::string text = resolved_text;
  for (const auto& file : std::set(files.begin(), files.end())) {
    const std::string before = naming(file), after = naming(place(file));
    if (before == after) continue;
    for (auto at = text.find(before); at != std::string::npos;
         at = text.find(before, at + after.size())) {
      text.replace(at, before.size(), after);
    }
  }
  return text;
}

}  // namespace palpate::scene
