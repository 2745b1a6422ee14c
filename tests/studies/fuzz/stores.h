// What the tests of this layer share.
#pragma once

#include "modules/core/data_folder.h"
#include "studies/fuzz/shape_store.h"

namespace palpate::fuzz::testing {

/// Gmsh fills its shapes: once per program.
inline const ShapeStore& shapes() {
  static const ShapeStore kShapes{data_file("scenes")};
  return kShapes;
}

}  // namespace palpate::fuzz::testing
