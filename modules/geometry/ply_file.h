// Surfaces from PLY files, read strictly.
#pragma once

#include <filesystem>
#include <string_view>

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// Vertices (x, y, z) and faces (vertex_indices or vertex_index) as they stand in a PLY file, text
/// or binary of either byte order; faces of more than three corners as fans (polygon_fan.h).
/// Other elements and properties are passed over. Of our own, because assimp 5.2 crashes on one in
/// twelve damaged files, and takes a first data byte that looks like a line end for the header's.
///   G. Turk, "The PLY Polygon File Format", 1994
/// @param bytes  the whole file
/// @param file   its name, for errors
/// @throws InputError naming the line of the header, or the element, that is wrong
TriangleSurface parse_ply(std::string_view bytes, const std::filesystem::path& file);

}  // namespace palpate::geometry
