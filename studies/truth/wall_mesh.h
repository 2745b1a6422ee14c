// The wall of a hollow organ as a solid: its surface, thickened inwards.
#pragma once

#include "modules/geometry/tet_mesh.h"

namespace palpate::truth {

struct WallMesh {
  geometry::TetMesh mesh;   ///< nodes of the surface first, each one's inner node as many later
  std::size_t thinned = 0;  ///< nodes where it is thinner, so that no tetrahedron turns inside out
};

/// One layer of prisms, each in three tetrahedra.
/// @param outer  closed, outward
/// @param thickness  > 0 [m]
/// @throws InputError if somewhere a tenth of it is too thick
WallMesh wall_under(const geometry::TriangleSurface& outer, double thickness);

}  // namespace palpate::truth
