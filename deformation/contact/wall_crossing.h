// Where a probe's core goes through a wall within a step, all along straight lines.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "modules/geometry/closest_points.h"

namespace palpate::deformation {

/// Where a core went through a triangle from its front to its back.
struct WallCrossing {
  std::uint32_t triangle = 0;
  double time = 0;              ///< fraction of the step
  double along = 0;             ///< of the core, from a to b
  Vec3 weights = Vec3::Zero();  ///< barycentric
  Vec3 normal = Vec3::UnitZ();  ///< outward, at that time
};

/// The line between a core's two ends in a step [m].
struct CoreWay {
  Vec3 a0, b0;  ///< at its start
  Vec3 a1, b1;  ///< at its end

  double length() const;  ///< of the longer way of an end [m]
};

/// The crossing of a triangle that moves by a point that rests at the origin.
std::optional<WallCrossing> crossing_of_point(const geometry::TriangleCorners& start,
                                              const geometry::TriangleCorners& end);

/// An edge of the wall, and what is opposite of it in its two triangles: p, q, and r, s, where p,
/// q, r is outward [m].
using EdgeCorners = std::array<Vec3, 4>;

/// The crossing of an edge by a core's side: it lay across the edge with both triangles beneath it.
/// Weights are of p, q and r.
std::optional<WallCrossing> crossing_of_side(const CoreWay& core, const EdgeCorners& start,
                                             const EdgeCorners& end);

}  // namespace palpate::deformation
