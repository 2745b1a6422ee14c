// Surfaces from OFF files, read strictly.
#pragma once

#include <filesystem>
#include <string_view>

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// Vertices and faces as they stand in an OFF file of text: the word OFF, the counts of vertices,
/// faces and edges, then a line for each vertex and each face; '#' begins a comment. What comes
/// behind a vertex's place (ST, C or N before OFF: texture, colour, normal) or a face's corners is
/// passed over. Of our own, because assimp 5.2 crashes on damaged ones, and closes surfaces that
/// name vertices that are not there.
///   Geomview manual, "OFF: the generic polyhedron file format"
/// @param bytes  the whole file
/// @param file   its name, for errors
/// @throws InputError naming the line that is wrong
TriangleSurface parse_off(std::string_view bytes, const std::filesystem::path& file);

}  // namespace palpate::geometry
