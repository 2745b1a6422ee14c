// Smaller triangles where a small thing touches.
#pragma once

#include "modules/geometry/triangle_surface.h"

namespace palpate::chart {

/// Halves longest edges until each edge is shorter than finest + growth · (distance of its middle
/// from `centre`). The shape stays: new nodes are middles of edges, behind the old ones.
///   M. Rivara, "Algorithms for refining triangular grids suitable for adaptive and multigrid
///   techniques", Int. J. Numer. Methods Eng. 20, 1984.
/// @param finest, growth  > 0 [m], [1]
geometry::TriangleSurface refine_around(geometry::TriangleSurface surface, const Vec3& centre,
                                        double finest, double growth);

}  // namespace palpate::chart
