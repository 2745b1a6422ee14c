// What the tests of this layer share.
#pragma once

#include "studies/fuzz/shape_store.h"

namespace palpate::fuzz::testing {

/// Gmsh fills its shapes: once per program.
inline const ShapeStore& shapes() {
  static const ShapeStore kShapes{std::filesystem::path(PALPATE_SOURCE_DIR) / "scenes"};
  return kShapes;
}

}  // namespace palpate::fuzz::testing
