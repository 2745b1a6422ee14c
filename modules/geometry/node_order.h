// Numbering of nodes so that neighbours lie near each other in memory.
#pragma once

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// Renumbers nodes breadth first from node 0 (further shells from their lowest node), and sorts
/// the triangles by their lowest node. Springs and one-rings then touch few cache lines.
/// Cuthill & McKee, "Reducing the bandwidth of sparse symmetric matrices", ACM 1969.
void order_nodes_by_neighbourhood(TriangleSurface& surface);

}  // namespace palpate::geometry
