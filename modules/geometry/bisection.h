// Tetrahedra halved where they are too large: conforming, and independent of history.
//
// A tetrahedron is only ever halved at its longest edge (of equal ones, the one that comes first by
// the places of its ends), so the tree of all halves is fixed by the mesh. What is returned are the
// leaves of its least conforming part that meets the sizes asked for: a tetrahedron with too long
// an edge is halved, and one that has lost an edge to a neighbour (Rivara, Int. J. Numer. Methods
// Eng. 20, 1984; Maubach, SIAM J. Sci. Comput. 16, 1995). The same sizes give the same mesh,
// whatever was asked for before.
#pragma once

#include <functional>

#include "modules/geometry/tet_mesh.h"

namespace palpate::geometry {

/// Longest edge allowed at a place [m], above 0.
using SizeField = std::function<double(const Vec3&)>;

/// Every edge is at most as long as `size` at its middle, and each tetrahedron's longest edge at
/// most as long as `size` at its corners' mean. Nodes of `mesh` keep their numbers; the faces stay
/// where they are.
/// @param mesh  conforming, volumes positive
/// @throws InputError if it would take more than `most_nodes` nodes
TetMesh bisected(const TetMesh& mesh, const SizeField& size, std::size_t most_nodes);

}  // namespace palpate::geometry
