// Meshing by running Gmsh as a tool. It ends with the program that runs it; a signal that somebody
// listens to ends it too, by a std::runtime_error.
#pragma once

#include <filesystem>
#include <string>

#include "modules/geometry/tet_mesh.h"

namespace palpate::geometry {

/// Fills a closed surface with tetrahedra. Its nodes and triangles stay as they are and come first;
/// nodes inside are appended.
/// @param size  wanted edge length inside, > 0 [m]
/// @throws InputError if gmsh is not installed or cannot fill the surface, or for far more nodes
///         than kMaxNodes
TetMesh fill_surface(const TriangleSurface& surface, double size);

/// Judged by its name, .msh or .vtk, as scenes and commands do: no tool for surfaces reads such.
bool is_tetrahedra_file(const std::filesystem::path& file);

/// Reads tetrahedra of any format Gmsh reads: MSH 2.2 text at once, others through Gmsh.
/// @throws InputError as read_gmsh(), with what to do about a file of a surface, or if gmsh is not
/// installed or cannot read the file
TetMesh read_tetrahedra(const std::filesystem::path& file);

enum class BallPart { kWhole, kOctant };  ///< octant: x, y, z ≥ 0

/// @param radius  of the ball about the origin, > 0 [m]
/// @param size    wanted edge length [m], an expression of Gmsh in x, y, z [m]: "0.01",
///                "0.002 + 0.1*z"
/// @throws InputError if gmsh is not installed or does not understand the expression
TetMesh mesh_ball(double radius, BallPart part, const std::string& size);

/// Axis-aligned block; `size` as in mesh_ball().
TetMesh mesh_block(const Vec3& low, const Vec3& high, const std::string& size);

/// Runs a Gmsh script (.geo) in three dimensions.
/// @throws InputError as above
TetMesh run_gmsh(const std::string& script);

}  // namespace palpate::geometry
