// Checks whether a surface can enclose a volume, and reports what is wrong if it cannot.
#pragma once

#include <string>
#include <vector>

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// A triangle with no more area than this part of the surface's extent squared is degenerate.
inline constexpr double kDegenerateArea = 1e-12;

struct MeshReport {
  std::size_t node_count = 0, triangle_count = 0;
  std::size_t component_count = 0;
  int genus = 0;                                              ///< of a closed one-component surface
  double area = 0, volume = 0;                                ///< [m²], [m³]
  Vec3 min_corner = Vec3::Zero(), max_corner = Vec3::Zero();  ///< [m]
  double shortest_edge = 0, longest_edge = 0;                 ///< [m]
  double worst_aspect = 0;  ///< largest √3/4·(longest edge)²/area; 1 = equilateral
  double leak = 0;          ///< largest difference of the three-axis volumes over the area·extent
  // Places: indices of offenders.
  std::vector<std::array<std::uint32_t, 2>> border_edges;        ///< in one triangle only
  std::vector<std::array<std::uint32_t, 2>> non_manifold_edges;  ///< in more than two triangles
  std::vector<std::uint32_t> non_manifold_nodes;                 ///< with more than one fan
  std::vector<std::uint32_t> unused_nodes;
  std::vector<std::uint32_t> degenerate_triangles;  ///< see kDegenerateArea
  std::vector<std::uint32_t> duplicate_triangles;
  std::vector<std::array<std::uint32_t, 2>> inconsistent_edges;  ///< same direction used twice
  std::vector<std::array<std::uint32_t, 2>> self_intersections;  ///< pairs of triangles
  bool inside_out = false;  ///< consistent, but the volume is negative

  /// No border, non-manifold, duplicate, degenerate, unused or inconsistent part.
  bool is_closed_manifold() const;
  /// Closed, manifold, one component, oriented outward, no degenerate or intersecting triangles.
  bool holds_volume() const;
};

/// Never throws for a finite surface with valid indices.
MeshReport check_surface(const TriangleSurface& surface);

/// Human-readable lines, most serious first: what is wrong, where (index and position in metres),
/// and what to do.
std::vector<std::string> describe_problems(const MeshReport& report,
                                           const TriangleSurface& surface);

}  // namespace palpate::geometry
