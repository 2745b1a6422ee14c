// Tetrahedral meshes in Gmsh's MSH 2.2 text format.
//   C. Geuzaine, J.-F. Remacle, "Gmsh: a three-dimensional finite element mesh generator with
//   built-in pre- and post-processing facilities", Int. J. Numer. Methods Eng. 79, 2009.
#pragma once

#include <filesystem>
#include <iosfwd>

#include "modules/geometry/tet_mesh.h"

namespace palpate::geometry {

/// Reads four-node tetrahedra; points, lines and triangles are skipped, as are sections other than
/// $Nodes and $Elements. Nodes of tetrahedra only, in the file's order.
/// @throws InputError naming file and line: missing, another version or binary, a number that is
///         none, a node or element named twice or missing, another element kind, a tetrahedron that
///         is flat or inside out, an unfinished section, no tetrahedra
TetMesh read_gmsh(const std::filesystem::path& file);

/// Writes the triangles of a surface, nodes numbered from 1 in their order.
/// @throws std::runtime_error if writing fails
void write_gmsh(const TriangleSurface& surface, const std::filesystem::path& file);
/// Writes tetrahedra, numbered alike, every bit of their nodes' places kept.
void write_gmsh(const TetMesh& mesh, std::ostream& out);

}  // namespace palpate::geometry
