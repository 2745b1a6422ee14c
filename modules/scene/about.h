// What the schema tells of a key beside its type, and keys that several objects have.
#pragma once

#include <limits>
#include <type_traits>

#include "modules/core/types.h"

namespace palpate::scene {

/// The words for the values of an enumeration, in its order.
template <class Enum>
struct Words;
template <class Enum>
const char* word_of(Enum value) {
  return Words<Enum>::texts[static_cast<std::size_t>(value)];
}
template <class T>
concept Enumeration = std::is_enum_v<T>;

/// What is known of a key beside its type.
struct About {
  const char* meaning = "";
  const char* unit = "";  ///< of the number or of each number of a list
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool required = false;
  const char* default_text = nullptr;  ///< said instead of the value, where none can be shown
  bool is_length_unit = false;         ///< a text naming a unit of length
  bool is_model = false;               ///< a text that is the word of a model

  About needed() const {
    About copy = *this;
    copy.required = true;
    return copy;
  }
  About otherwise(const char* text) const {
    About copy = *this;
    copy.default_text = text;
    return copy;
  }
};

inline About ranged(const char* unit, double min, double max, const char* meaning) {
  return {.meaning = meaning, .unit = unit, .min = min, .max = max};
}
inline About plain(const char* meaning) { return {.meaning = meaning}; }
/// A point of W. Bounded, because positions cross the wire as float32: 8 µm at 100 m.
inline About point(const char* meaning) { return ranged("m", -100, 100, meaning); }

/// Keys of a pose, among those of the object that has it.
template <class V>
void describe_pose(V& v, Pose& pose, const char* position, const char* rotation) {
  v.field("position_m", pose.position, point(position));
  v.field("rotation_xyzw", pose.rotation, plain(rotation));
}

}  // namespace palpate::scene
