// One value of a scene file with its place, and its strict conversion to the types of a scene.
// Every refusal is an InputError "file:line: key 'a.b[0].c' = 'value': must be …".
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <span>
#include <string>

#include "modules/scene/schema.h"

namespace palpate::scene {

/// Origin of a text.
struct Source {
  std::string name;              ///< as shown in messages
  std::filesystem::path folder;  ///< that relative file names refer to
};

/// The part of a text that a message repeats: one line, at most 60 bytes.
std::string shortened(std::string text);
/// What is wrong with a text that is no YAML.
std::string why_not_yaml(const YAML::Exception& error);
/// Where a key, or an entry of a list, begins; one that is not of a text has the line `otherwise`.
int line_of(const YAML::Node& node, int otherwise);

struct YamlValue {
  YAML::Node node;
  int line = 1;     ///< of its key: a value may begin further down, or be nothing
  std::string key;  ///< full, "organs[0].tissue.drag_per_s"; empty for the whole scene
  const Source* source;

  std::string key_below(const std::string& name) const;     ///< full key of an entry
  [[noreturn]] void refuse(const std::string& must) const;  ///< throws; `must` says what is allowed
};

double number_from(const YamlValue& value, const About& about);
std::size_t count_from(const YamlValue& value, const About& about);
bool flag_from(const YamlValue& value);
/// 1 … 255 bytes without control characters; with about.is_length_unit, a unit of length;
/// with about.is_model, the word of a model.
std::string text_from(const YamlValue& value, const About& about);
/// The index of one of `words`.
std::size_t word_from(const YamlValue& value, std::span<const char* const> words);
Vec3 vector_from(const YamlValue& value, const About& about);
/// Unit within 1e-3, then normalised.
Quat rotation_from(const YamlValue& value);
/// Absolute path of a file that exists and can be read.
std::filesystem::path file_from(const YamlValue& value);

/// Throws unless `text` is acceptable as a name; see text_from().
void check_name(const YamlValue& value, const std::string& text);

/// A list of the entries; throws unless the value is a list.
std::vector<YamlValue> entries_of(const YamlValue& value);

}  // namespace palpate::scene
