// The keys an object of the scene may have.
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "modules/scene/schema.h"

namespace palpate::scene {

/// Visitor of the schema (see schema.h) that notes the keys.
struct KeyList {
  std::vector<std::string> keys;  ///< in the schema's order
  std::vector<std::string> required;
  bool choose_one = false;  ///< the keys are the options of a variant

  template <class T>
  void field(const char* key, T&, const About& about) {
    keys.push_back(key);
    if (about.required) required.push_back(key);
  }
  template <class T, class Variant>
  void option(const char* key, Variant&, const About&) {
    keys.push_back(key);
    choose_one = true;
  }
  void require(bool, const char*) {}
  void fits(const char*, const Misfit&) {}
  template <class T>
  void unique_names(const char*, const std::vector<T>&) {}
};

template <class T>
KeyList keys_of() {
  KeyList list;
  T object;
  describe(list, object);
  return list;
}

}  // namespace palpate::scene
