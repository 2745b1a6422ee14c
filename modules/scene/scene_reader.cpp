#include "modules/scene/scene_reader.h"

#include "modules/core/input_file.h"
#include "modules/core/organ_limits.h"
#include "modules/scene/object_reader.h"
#include "modules/scene/scene_error.h"
#include "modules/scene/scene_tree.h"

namespace palpate::scene {

YAML::Node parse_yaml(std::string_view text, const Source& source) {
  if (text.size() > kMaxTextBytes) {
    throw SceneError(source.name, 0, "",
                     "longer than a scene may be (" + std::to_string(kMaxTextBytes) + " bytes)");
  }
  using namespace std::string_view_literals;
  for (const auto mark : {"\xFF\xFE"sv, "\xFE\xFF"sv, "\0\0\xFE\xFF"sv}) {
    if (text.starts_with(mark))
      throw SceneError(source.name, 1, "", "is UTF-16 or UTF-32; save it as UTF-8");
  }
  try {
    // The end mark makes yaml-cpp refuse a quoted text that is never closed.
    const auto documents = YAML::LoadAll(std::string(text) + "\n...\n");
    if (documents.size() > 1) {
      throw SceneError(source.name, 0, "", "holds more than one YAML document ('---' or '...')");
    }
    return documents.empty() ? YAML::Node() : documents.front();
  } catch (const YAML::Exception& error) {
    throw SceneError(source.name, error.mark.line + 1, "",
                     "not valid YAML: " + why_not_yaml(error));
  }
}

namespace {

void check_first_key(const YamlValue& root) {
  const std::string wanted = std::string(kFormatKey) + ": " + std::to_string(kSceneFormat);
  if (root.node.IsNull()) throw SceneError(root.source->name, root.line, "", "the scene is empty");
  if (!root.node.IsMap() || root.node.size() == 0) {
    root.refuse("must be a mapping that begins with " + wanted);
  }
  const YAML::Node first = root.node.begin()->first;
  if (!first.IsScalar() || first.Scalar() != kFormatKey) {
    throw SceneError(root.source->name, line_of(first, root.line), kFormatKey,
                     "the first key must be " + wanted);
  }
  // Before what else is missing: another version may name it otherwise.
  About version;
  version.min = version.max = kSceneFormat;
  count_from({root.node.begin()->second, line_of(first, root.line), kFormatKey, root.source},
             version);
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
  if (const std::string why = why_not_readable(file); !why.empty()) {
    throw SceneError(file.string(), 0, "", why);
  }
  return parse_scene(read_input(file, kMaxTextBytes), file);
}

Scene parse_scene(std::string_view text, const std::filesystem::path& file) {
  const Source source{file.string(), file.parent_path()};
  return scene_from(parse_yaml(text, source), file);
}

Scene scene_from(const YAML::Node& tree, const std::filesystem::path& file) {
  const Source source{file.string(), file.parent_path()};
  const YamlValue root{tree, 1, "", &source};
  check_first_key(root);
  Scene scene;
  ObjectReader::read_object(root, scene);
  scene.file = file;
  if (scene.name.empty()) {
    scene.name = file.stem().string();
    check_name({YAML::Node(scene.name), 1, "name", &source}, scene.name);
  }
  return scene;
}

EmulatedDevice parse_emulated_device(std::string_view text, const std::string& source,
                                     const TopicDevice& place) {
  const Source origin{source, {}};
  YamlValue keys{parse_yaml(text, origin), 1, "", &origin};
  if (keys.node.IsNull()) keys.node = YAML::Node(YAML::NodeType::Map);
  if (keys.node.IsMap() && !keys.node["start_m"].IsDefined()) {
    for (const double coordinate : place.start) keys.node["start_m"].push_back(coordinate);
  }
  EmulatedDevice device;
  device.rotation = place.rotation;
  ObjectReader::read_object(keys, device);
  return device;
}

}  // namespace palpate::scene
