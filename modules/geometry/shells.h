// A surface's separate parts, and the holes in it.
#pragma once

#include <cstddef>
#include <vector>

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// The parts that share no node, the one that encloses most first; nodes no triangle uses are left
/// out. Of one part: the surface itself.
std::vector<TriangleSurface> shells_of(const TriangleSurface& surface);

/// Closes each hole with triangles about a new node in the middle of its border. A border that runs
/// through a node twice is left open.
/// @return how many were closed
std::size_t fill_holes(TriangleSurface& surface);

}  // namespace palpate::geometry
