// Consistent, outward orientation of triangles.
#pragma once

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

struct OrientationLog {
  std::size_t flipped_triangles = 0;  ///< turned to agree with the rest of their shell
  std::size_t flipped_shells = 0;     ///< closed shells turned as a whole
};

/// Turns triangles so that neighbours over an edge of exactly two triangles agree (in each shell
/// the majority stays), then turns each closed shell of negative volume. A surface that cannot be
/// oriented keeps some disagreeing edges.
OrientationLog orient_outward(TriangleSurface& surface);

}  // namespace palpate::geometry
