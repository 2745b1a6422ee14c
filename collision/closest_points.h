// Closest points of points, segments and triangles (Ericson, Real-Time Collision Detection, 2005,
// §5.1). Triangles must not be degenerate; segments may be.
#pragma once

#include <array>

#include "modules/core/types.h"

namespace palpate::collision {

using TriangleCorners = std::array<Vec3, 3>;  ///< [m]

struct PointOnTriangle {
  Vec3 point = Vec3::Zero();    ///< [m]
  Vec3 weights = Vec3::Zero();  ///< barycentric, ≥ 0, sum 1; exactly 0 off the closest feature
};

/// Closest point of a triangle to p.
PointOnTriangle closest_on_triangle(const Vec3& p, const TriangleCorners& triangle);

struct SegmentPair {
  double s = 0, t = 0;                                     ///< in [0, 1], on first and second
  Vec3 on_first = Vec3::Zero(), on_second = Vec3::Zero();  ///< [m]
};

/// Closest points of segments a0–a1 and b0–b1; for parallel ones, one of the closest pairs.
SegmentPair closest_of_segments(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1);

struct SegmentAndTriangle {
  Vec3 on_segment = Vec3::Zero();  ///< [m]
  PointOnTriangle on_triangle;
  double distance = 0;  ///< [m]; 0 where they intersect
};

/// Closest points of segment a–b and a triangle; where they intersect, the point of intersection.
SegmentAndTriangle closest_of_segment_and_triangle(const Vec3& a, const Vec3& b,
                                                   const TriangleCorners& triangle);

/// Unit normal; zero for a triangle that is degenerate (area below 1e-12 of its longest edge
/// squared) or not finite.
Vec3 unit_normal(const TriangleCorners& triangle);

}  // namespace palpate::collision
