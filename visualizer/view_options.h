// Parts of the picture that the person looking has switched on.
#pragma once

#include <array>

namespace palpate::visualizer {

enum class Coloring { kStrain, kDisplacement };

struct ViewOptions {
  Coloring coloring = Coloring::kStrain;
  std::array<bool, 3> springs{false, false, false};  ///< by SpringFamily
  bool help = false;
};

}  // namespace palpate::visualizer
