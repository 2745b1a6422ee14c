// A value of a scene without its YAML or C++ type: what a program that knows the keys only at run
// time sets and gets.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "modules/scene/scene.h"

namespace palpate::scene {

struct SceneValue {
  using List = std::vector<SceneValue>;
  using Map = std::vector<std::pair<std::string, SceneValue>>;
  /// Nothing: the key is absent, its default holds.
  std::variant<std::monostate, bool, std::int64_t, double, std::string, List, Map> content;
};

/// Every key of the scene with its value, defaults included; of an optional one that is absent,
/// nothing.
SceneValue value_of(const Scene& scene);

}  // namespace palpate::scene
