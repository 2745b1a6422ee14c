#include "modules/scene/settings.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>

#include "modules/core/error.h"
#include "modules/scene/scene_error.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/yaml_value.h"

namespace palpate::scene {
namespace {

/// Numbers are decimal, as in a scene file: neither 0x10 nor an octal 010.
template <class Number>
bool is_number(const std::string& text, Number& number) {
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  return parsed.ec == std::errc{} && parsed.ptr == text.data() + text.size();
}

SceneValue plain_value(const std::string& text) {
  if (std::int64_t whole = 0; is_number(text, whole)) return {whole};
  if (double number = 0; is_number(text, number)) return {number};
  if (text == "true" || text == "false") return {text == "true"};
  return {text};
}

/// An anchor may hold itself: no value of a scene is as deep.
constexpr int kDeepest = 32;

/// @throws InputError for one that is deeper
SceneValue value_of(const YAML::Node& node, int depth = 0) {
  if (depth > kDeepest) throw InputError("setting: its value is nested too deep");
  if (node.IsSequence()) {
    SceneValue::List list;
    for (const auto& entry : node) list.push_back(value_of(entry, depth + 1));
    return {list};
  }
  if (node.IsMap()) {
    SceneValue::Map map;
    for (const auto& entry : node) {
      const std::string key = entry.first.Scalar();
      if (std::ranges::find(map, key, [](const auto& known) { return known.first; }) != map.end())
        throw InputError("setting: key '" + key + "' is given twice");
      map.emplace_back(key, value_of(entry.second, depth + 1));
    }
    return {map};
  }
  if (!node.IsScalar()) return {};
  const bool quoted = node.Tag() == "!";
  return quoted ? SceneValue{node.Scalar()} : plain_value(node.Scalar());
}

}  // namespace

SceneDocument::Change change_from(const std::string& setting) {
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError("setting '" + setting +
                     "': must be KEY=VALUE, such as rates.deformation_hz=200");
  }
  const std::string key = setting.substr(0, equals);
  // Of a shell's variable that is not set: the schema's default would not be what was meant.
  if (setting.find_first_not_of(" \t\r\n", equals + 1) == std::string::npos) {
    throw InputError("setting '" + setting +
                     "': has no value; null gives the default, '' an empty text");
  }
  try {
    const auto values = YAML::LoadAll(setting.substr(equals + 1));
    if (values.size() > 1) throw InputError("setting '" + key + "': must be one value");
    return {key, values.empty() ? SceneValue{} : value_of(values.front())};
  } catch (const YAML::Exception& error) {
    throw InputError("setting '" + setting +
                     "': its value is not valid YAML: " + why_not_yaml(error));
  }
}

namespace {

/// Whether one of these is the other, or holds it.
bool overlap(const std::string& a, const std::string& b) {
  const auto& [shorter, longer] =
      std::minmax(a, b, [](const auto& x, const auto& y) { return x.size() < y.size(); });
  if (shorter.empty() || !longer.starts_with(shorter)) return false;
  return longer.size() == shorter.size() || longer[shorter.size()] == '.' ||
         longer[shorter.size()] == '[';
}

/// The scene's own lines are sound: it is the setting that is not, or what it does to other keys.
[[noreturn]] void blame_settings(const SceneError& error,
                                 const std::vector<std::string>& settings) {
  const std::string what = error.what();
  const std::string place =
      error.file + (error.line > 0 ? ":" + std::to_string(error.line) : "") + ": ";
  const std::string problem = what.starts_with(place) ? what.substr(place.size()) : what;
  for (auto setting = settings.rbegin(); setting != settings.rend(); ++setting) {
    if (!overlap(setting->substr(0, setting->find('=')), error.key)) continue;
    throw SceneError("--set " + *setting, 0, error.key, problem);
  }
  throw SceneError(error.file, error.line, error.key, problem + " (with what --set changes)");
}

}  // namespace

Scene load_scene_with(const std::filesystem::path& file, const std::vector<std::string>& settings) {
  if (settings.empty()) return load_scene(file);
  SceneDocument document(file);
  std::vector<SceneDocument::Change> changes;
  for (const auto& setting : settings) changes.push_back(change_from(setting));
  try {
    document.change(changes);
  } catch (const SceneError& error) {
    blame_settings(error, settings);
  }
  return document.scene();
}

}  // namespace palpate::scene
