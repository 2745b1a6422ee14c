// A polygon as triangles that share one of its corners.
#pragma once

#include <cstdint>
#include <span>

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// Appends them to the surface whose nodes the corners are; none of fewer than three corners. The
/// shared one is the first from which no triangle is turned over, as two are of four in a hollow
/// quadrangle; of a polygon that has none, or more than 64 corners, it is the first.
void add_fan(std::span<const std::uint32_t> corners, TriangleSurface& surface);

}  // namespace palpate::geometry
