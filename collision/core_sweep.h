// A core (point or segment, at rest in P) against one moving triangle. A sphere is a point with a
// radius, a capsule a segment with one, a corner of a box or mesh a point with radius 0.
#pragma once

#include <optional>

#include "collision/relative_motion.h"

namespace palpate::collision {

struct Core {
  std::uint32_t index = 0;  ///< of this core in its probe
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
  double radius = 0;  ///< [m], ≥ 0

  bool is_point() const { return a == b; }
};

/// Closest points of core and triangle at one time.
geometry::SegmentAndTriangle closest(const Core& core, const geometry::TriangleCorners& triangle);

/// Lower bound, up to a millionth of the radius, of the first time core and triangle are closer
/// than the radius; 1 if they never are. Conservative advancement: no corner moves further than
/// `travel`, so neither does the distance change faster.
double time_of_touch(const Core& core, const SweptTriangle& triangle);

/// Where core and triangle are closest within [from, 1].
struct ClosestApproach {
  double time = 0;
  geometry::SegmentAndTriangle pair;
};
ClosestApproach closest_approach(const Core& core, const SweptTriangle& triangle, double from);

/// Where the core met the triangle itself.
struct Crossing {
  double time = 0;
  Vec3 on_core = Vec3::Zero();
  Vec3 weights = Vec3::Zero();  ///< barycentric
};

/// First meeting of core and triangle, with continuous collision detection: none is missed.
std::optional<Crossing> first_crossing(const Core& core, const SweptTriangle& triangle,
                                       double separation);

}  // namespace palpate::collision
