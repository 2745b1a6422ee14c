// Turns a user's mesh into an organ's surface: loads it, repairs what is safe, resamples.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "modules/geometry/mesh_check.h"

namespace palpate::geometry {

struct RepairLog {
  std::vector<std::string> actions;  ///< what was done, one line each; empty if nothing
};

/// Welds coincident nodes, closes cracks thinner than 1e-6 of the size, drops unused nodes,
/// duplicate and degenerate triangles, and orients all triangles consistently outward. Does nothing
/// that changes the shape.
RepairLog repair_surface(TriangleSurface& surface);

/// Decimates or refines a closed manifold surface to exactly `node_count` nodes where reachable
/// (else the nearest count), keeping it closed, manifold and free of self-intersections; scales
/// about the centroid so that the enclosed volume is kept. Edges become nearly equal and sharp
/// corners a little rounder. A surface that has this count already is returned as it is.
/// Deterministic.
/// @param node_count  4 … kMaxNodes
/// @param progress    called again and again with the part that is done, 0 … 1
/// @throws InputError if the surface cannot be resampled; Interrupted if a signal of StopSignal
/// comes
TriangleSurface resample_surface(const TriangleSurface& surface, std::size_t node_count,
                                 const std::function<void(double)>& progress = {});

/// Reads, repairs, resamples if node_count > 0, and checks.
/// @param admit  may refuse the surface by an InputError before it is checked, which takes as long
///               as there are pairs of triangles at a node
/// @param progress  as resample_surface()
/// @throws InputError naming file, problems and what to do if the result cannot hold a volume;
/// Interrupted as resample_surface()
TriangleSurface load_organ_surface(const std::filesystem::path& file, std::string_view unit,
                                   std::size_t node_count,
                                   const std::function<void(const TriangleSurface&)>& admit = {},
                                   const std::function<void(double)>& progress = {});

}  // namespace palpate::geometry
