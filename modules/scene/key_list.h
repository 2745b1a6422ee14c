// The keys an object of the scene may have.
#pragma once

#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "modules/scene/schema.h"

namespace palpate::scene {

/// Visitor of the schema (see schema.h) that notes the keys.
struct KeyList {
  std::vector<std::string> keys;      ///< in the schema's order
  std::vector<std::string> meanings;  ///< of each
  std::vector<std::string> required;
  bool choose_one = false;  ///< the keys are the options of a variant

  template <class T>
  void field(const char* key, T&, const About& about) {
    keys.push_back(key);
    meanings.push_back(about.meaning);
    if (about.required) required.push_back(key);
  }
  template <class T, class Variant>
  void option(const char* key, Variant&, const About& about) {
    keys.push_back(key);
    meanings.push_back(about.meaning);
    choose_one = true;
  }
  void require(bool, const char*) {}
  void fits(const char*, const Misfit&) {}
  template <class T>
  void unique_names(const char*, const std::vector<T>&) {}
};

/// Visitor of the schema that finds the word of the option a variant holds.
struct ChosenOption {
  std::string word;

  template <class T, class Variant>
  void option(const char* key, Variant& variant, const About&) {
    if (std::holds_alternative<T>(variant)) word = key;
  }
};

/// "sphere", of a probe's shape; "scripted", of its device.
template <class Variant>
std::string word_of_option(Variant variant) {
  ChosenOption chosen;
  describe(chosen, variant);
  return chosen.word;
}

template <class T>
KeyList keys_of() {
  KeyList list;
  T object;
  describe(list, object);
  return list;
}

}  // namespace palpate::scene
