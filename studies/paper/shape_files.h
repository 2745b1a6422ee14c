// Shapes as CSV, for the pictures.
#pragma once

#include <filesystem>
#include <string>

#include "modules/messages/messages.h"

namespace palpate::paper {

/// folder/NAME_triangles.csv (a, b, c: rows of the nodes file) and folder/NAME_springs.csv (family
/// 0 structural, 1 bending, 2 inner; a, b).
void write_topology(const SurfaceTopology& topology, const std::filesystem::path& folder,
                    const std::string& name, bool springs);

/// folder/NAME_nodes.csv: x_m, y_m, z_m, rest_x_m, rest_y_m, rest_z_m, kind (0 surface, 1 fixed
/// surface, 2 virtual), one row per node.
void write_nodes(const SurfaceTopology& topology, const std::vector<float>& positions,
                 const std::filesystem::path& folder, const std::string& name);

}  // namespace palpate::paper
