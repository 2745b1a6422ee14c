// Mesh import and export (the only user of assimp).
#pragma once

#include <filesystem>

#include "modules/geometry/tet_mesh.h"

namespace palpate::geometry {

inline constexpr std::size_t kMaxMeshFileBytes = std::size_t{1} << 30;  ///< before it is resampled

/// Reads any surface format assimp reads, merges all its meshes, triangulates, welds vertices at
/// the same position, and scales to metres.
/// @param unit  unit of the file's numbers, see metres_per_unit()
/// @throws InputError naming the file and what is wrong (missing, not a mesh, no triangles,
///         not finite, index out of range).
TriangleSurface read_surface(const std::filesystem::path& file, std::string_view unit);

/// @throws InputError for an extension write_surface() does not know
void check_can_write(const std::filesystem::path& file);
/// The same of write_tetrahedra().
void check_can_write_tetrahedra(const std::filesystem::path& file);

/// Writes by file extension (ply, stl, obj, off), in metres; whole file or nothing.
/// @throws InputError for an extension not known; std::runtime_error if writing fails.
void write_surface(const TriangleSurface& surface, const std::filesystem::path& file);
/// The same of tetrahedra: msh (MSH 2.2, text) alone.
void write_tetrahedra(const TetMesh& mesh, const std::filesystem::path& file);

}  // namespace palpate::geometry
