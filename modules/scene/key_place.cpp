#include "modules/scene/key_place.h"

#include <algorithm>
#include <exception>
#include <string_view>

#include "modules/core/input_file.h"
#include "modules/core/organ_limits.h"
#include "modules/scene/scene_tree.h"

namespace palpate::scene {
namespace {

YAML::Node nothing() { return YAML::Node(YAML::NodeType::Undefined); }

/// Of a list the one with a number or a name.
YAML::Node entry_of(const YAML::Node& list, const std::string& which) {
  if (!list.IsSequence()) return nothing();
  if (which.find_first_not_of("0123456789") == std::string::npos) return list[std::stoul(which)];
  for (const YAML::Node& entry : list) {
    if (!entry.IsMap()) continue;
    const YAML::Node name = entry["name"];
    if (name.IsDefined() && name.IsScalar() && name.Scalar() == which) return entry;
  }
  return nothing();
}

/// Of "a[2].b", as far as the tree has it.
/// @param line  of what holds the node
int line_below(const YAML::Node& node, std::string_view path, int line) {
  if (!node.IsDefined() || node.IsNull()) return line;
  const int own = line_of(node, line);
  if (path.empty()) return own;
  if (path.front() == '[') {
    const std::size_t end = path.find(']');
    std::string_view rest = path.substr(end + 1);
    if (rest.starts_with('.')) rest.remove_prefix(1);
    return line_below(entry_of(node, std::string(path.substr(1, end - 1))), rest, own);
  }
  const std::size_t end = std::min(path.find_first_of(".["), path.size());
  std::string_view rest = path.substr(end);
  if (rest.starts_with('.')) rest.remove_prefix(1);
  const std::string key(path.substr(0, end));
  return line_below(node.IsMap() ? node[key] : nothing(), rest, own);
}

}  // namespace

SceneError error_at(const Scene& scene, const std::string& key, const std::string& problem) {
  int line = 0;
  try {
    const Source source{scene.file.string(), scene.file.parent_path()};
    line = line_below(parse_yaml(read_input(scene.file, kMaxTextBytes), source), key, 1);
  } catch (const std::exception&) {  // it has been accepted: the problem is another one
  }
  return {scene.file.empty() ? "scene" : scene.file.string(), line, key, problem};
}

}  // namespace palpate::scene
