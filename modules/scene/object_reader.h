// Visitor of the schema (see schema.h) that fills an object from a mapping of a scene file.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "modules/core/organ_limits.h"
#include "modules/scene/key_list.h"
#include "modules/scene/yaml_value.h"

namespace palpate::scene {

class ObjectReader {
 public:
  /// @throws InputError unless `object` is a mapping with allowed keys only, each once, none
  ///         missing, and exactly one where they are options
  ObjectReader(const YamlValue& object, const KeyList& allowed);

  void field(const char* key, double& field, const About& about) {
    if (const auto value = find(key)) field = number_from(*value, about);
  }
  void field(const char* key, std::size_t& field, const About& about) {
    if (const auto value = find(key)) field = count_from(*value, about);
  }
  void field(const char* key, bool& field, const About&) {
    if (const auto value = find(key)) field = flag_from(*value);
  }
  void field(const char* key, std::string& field, const About& about) {
    if (const auto value = find(key)) field = text_from(*value, about);
  }
  void field(const char* key, std::filesystem::path& field, const About&) {
    if (const auto value = find(key)) field = file_from(*value);
  }
  void field(const char* key, Vec3& field, const About& about) {
    if (const auto value = find(key)) field = vector_from(*value, about);
  }
  void field(const char* key, Quat& field, const About&) {
    if (const auto value = find(key)) field = rotation_from(*value);
  }
  template <Enumeration Enum>
  void field(const char* key, Enum& field, const About&) {
    if (const auto value = find(key)) {
      field = static_cast<Enum>(word_from(*value, Words<Enum>::texts));
    }
  }
  template <class T>
  void field(const char* key, std::optional<T>& optional, const About& about) {
    optional.reset();
    if (find(key)) field(key, optional.emplace(), about);
  }
  void field(const char* key, std::vector<std::string>& list, const About& about) {
    const auto value = find(key);
    if (!value) return;
    list.clear();
    for (const YamlValue& entry : entries_of(*value)) list.push_back(text_from(entry, about));
  }
  template <class T>
  void field(const char* key, std::vector<T>& list, const About& about) {
    if (const auto value = find(key)) read_list(*value, list, about);
  }
  template <class T>
  void field(const char* key, T& object, const About&) {
    if (const auto value = find(key)) read_object(*value, object);
  }

  template <class T, class Variant>
  void option(const char* key, Variant& variant, const About&) {
    if (const auto value = find(key)) read_object(*value, variant.template emplace<T>());
  }

  void require(bool holds, const char* rule) const {
    if (!holds) object_.refuse(rule);
  }
  void fits(const char*, const Misfit& misfit) const {
    if (!misfit.none()) value_at(misfit.key).refuse(misfit.why);
  }

  template <class T>
  void unique_names(const char* key, const std::vector<T>& list) const {
    if (list.size() > kMaxKeys) refuse_many(key, list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        if (list[i].name == list[k].name) refuse_name(key, i, k, list[i].name);
      }
    }
  }

  template <class T>
  static void read_object(const YamlValue& value, T& object) {
    ObjectReader reader(value, keys_of<T>());
    describe(reader, object);
  }

 private:
  template <class T>
  static void read_list(const YamlValue& value, std::vector<T>& list, const About& about) {
    list.clear();
    for (const YamlValue& entry : entries_of(value)) read_object(entry, list.emplace_back());
    if (about.required && list.empty()) value.refuse("must have at least one entry");
  }

  std::optional<YamlValue> find(const std::string& key) const;
  /// Of "a.b" or "a[2].b"; where a default is meant, of what would hold it.
  YamlValue value_at(const std::string& path) const;
  void check_keys(const KeyList& allowed) const;
  void check_options(const KeyList& allowed) const;
  [[noreturn]] void refuse_key(const YAML::Node& key, const KeyList& allowed) const;
  [[noreturn]] void refuse_many(const char* key, std::size_t count) const;
  [[noreturn]] void refuse_name(const char* key, std::size_t index, std::size_t same_as,
                                const std::string& name) const;

  YamlValue object_;
};

}  // namespace palpate::scene
