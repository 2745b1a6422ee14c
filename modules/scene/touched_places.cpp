#include "modules/scene/touched_places.h"

#include <algorithm>
#include <limits>

#include "modules/geometry/closest_points.h"
#include "modules/geometry/winding_number.h"

namespace palpate::scene {
namespace {

constexpr double kSpacing = 0.75;  // radii, between balls

}  // namespace

Touch touch_of(const geometry::TriangleSurface& skin, const geometry::RoundedSegment& probe) {
  geometry::SegmentAndTriangle nearest;
  nearest.distance = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : skin.triangles) {
    const geometry::TriangleCorners corners{skin.nodes[a], skin.nodes[b], skin.nodes[c]};
    const auto found = geometry::closest_of_segment_and_triangle(probe.a, probe.b, corners);
    if (found.distance < nearest.distance) nearest = found;
  }
  Touch touch{nearest.on_triangle.point, Vec3::Zero(), 0};
  // Of all triangles the probe would dent: one alone may lean away.
  for (const auto& [a, b, c] : skin.triangles) {
    const geometry::TriangleCorners corners{skin.nodes[a], skin.nodes[b], skin.nodes[c]};
    const double away =
        (geometry::closest_on_triangle(touch.place, corners).point - touch.place).norm();
    if (away < probe.radius) {
      touch.outward += (probe.radius - away) * geometry::unit_normal(corners);
    }
  }
  touch.outward.normalize();
  const bool is_inside =
      geometry::winding_number(nearest.on_segment, skin.nodes, skin.triangles) > 0.5;
  touch.depth = probe.radius - (is_inside ? -nearest.distance : nearest.distance);
  return touch;
}

void add_touched(const geometry::TriangleSurface& skin, const geometry::RoundedSegment& probe,
                 std::vector<SphereRegion>& balls) {
  const Touch touch = touch_of(skin, probe);
  if (touch.depth < 0) return;
  const bool is_covered = std::any_of(balls.begin(), balls.end(), [&](const auto& ball) {
    return (ball.center - touch.place).norm() < kSpacing * probe.radius;
  });
  if (!is_covered) balls.push_back({touch.place, probe.radius});
}

}  // namespace palpate::scene
