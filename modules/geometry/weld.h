// Joining of nodes at the same place.
#pragma once

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// Joins nodes with exactly equal coordinates; the first of each place stays, the order is kept.
/// Triangles that lose a corner by it stay in the list.
/// @return number of nodes removed
std::size_t weld_nodes(TriangleSurface& surface);

/// Joins nodes on open edges that are nearer than `tolerance` [m] to each other: cracks left by the
/// rounding of single-precision files. Closed parts are not touched. @return number of nodes
/// removed
std::size_t weld_cracks(TriangleSurface& surface, double tolerance);

/// Removes nodes of no triangle, keeping the order. @return number of nodes removed
std::size_t drop_unused_nodes(TriangleSurface& surface);

}  // namespace palpate::geometry
