#include "modules/scene/scene_value.h"

#include <optional>

#include "modules/scene/schema.h"

namespace palpate::scene {
namespace {

/// Visitor of the schema (see schema.h) that lists an object's keys with their values.
class ValueLister {
 public:
  SceneValue::Map values;

  void field(const char* key, double value, const About&) { add(key, {value}); }
  void field(const char* key, std::size_t value, const About&) {
    add(key, {static_cast<std::int64_t>(value)});
  }
  void field(const char* key, bool value, const About&) { add(key, {value}); }
  void field(const char* key, std::string& value, const About&) { add(key, {value}); }
  void field(const char* key, std::filesystem::path& value, const About&) {
    add(key, {value.string()});
  }
  void field(const char* key, Vec3& value, const About&) { add_numbers(key, value.data(), 3); }
  void field(const char* key, Quat& value, const About&) {
    add_numbers(key, value.coeffs().data(), 4);
  }
  template <Enumeration Enum>
  void field(const char* key, Enum& value, const About&) {
    add(key, {std::string(word_of(value))});
  }
  template <class T>
  void field(const char* key, std::optional<T>& value, const About& about) {
    if (value) return field(key, *value, about);
    add(key, {});
  }
  void field(const char* key, std::vector<std::string>& list, const About&) {
    SceneValue::List entries;
    for (const auto& entry : list) entries.push_back({entry});
    add(key, {std::move(entries)});
  }
  template <class T>
  void field(const char* key, std::vector<T>& list, const About&) {
    SceneValue::List entries;
    for (T& entry : list) entries.push_back(listed(entry));
    add(key, {std::move(entries)});
  }
  template <class T>
  void field(const char* key, T& object, const About&) {
    add(key, listed(object));
  }
  template <class T, class Variant>
  void option(const char* key, Variant& variant, const About&) {
    if (T* chosen = std::get_if<T>(&variant)) add(key, listed(*chosen));
  }
  void require(bool, const char*) {}
  void fits(const char*, const Misfit&) {}
  template <class T>
  void unique_names(const char*, const std::vector<T>&) {}

  template <class T>
  static SceneValue listed(T& object) {
    ValueLister lister;
    describe(lister, object);
    return {std::move(lister.values)};
  }

 private:
  void add(const char* key, SceneValue value) { values.emplace_back(key, std::move(value)); }
  void add_numbers(const char* key, const double* numbers, std::size_t count) {
    SceneValue::List list;
    for (std::size_t i = 0; i < count; ++i) list.push_back({numbers[i]});
    add(key, {std::move(list)});
  }
};

}  // namespace

SceneValue value_of(const Scene& scene) {
  Scene copy = scene;  // a description may be given what it describes to fill
  return ValueLister::listed(copy);
}

}  // namespace palpate::scene
