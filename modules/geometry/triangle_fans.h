// Triangles in runs around nodes.
#pragma once

#include <cstdint>
#include <vector>

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// Neighbours of each node counter-clockwise as seen from outside, from the lowest on.
/// @param triangles  closed, oriented, one fan per node
std::vector<std::vector<std::uint32_t>> ordered_one_rings(const std::vector<Triangle>& triangles,
                                                          std::size_t node_count);

/// A run of triangles around a node: (center, nodes[i], nodes[i+1]), oriented.
struct Fan {
  std::uint32_t center = 0;
  std::vector<std::uint32_t> nodes;
};

/// Every triangle in one fan, in few fans: a node with most triangles left comes first and takes
/// them.
std::vector<Fan> fans_of(const std::vector<std::vector<std::uint32_t>>& rings);

}  // namespace palpate::geometry
