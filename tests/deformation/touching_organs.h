// Organs that touch each other, and what must never be of them.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "modules/geometry/self_intersection.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation::testing {

/// Of all surfaces, together and each with itself.
inline bool any_triangles_cross(
    const std::vector<std::pair<std::span<const Vec3>, const Body*>>& organs) {
  geometry::TriangleSurface all;
  for (const auto& [positions, body] : organs) {
    const auto shift = static_cast<std::uint32_t>(all.nodes.size());
    all.nodes.insert(all.nodes.end(), positions.begin(),
                     positions.begin() + static_cast<std::ptrdiff_t>(body->surface_node_count));
    for (const auto& [a, b, c] : body->triangles)
      all.triangles.push_back({a + shift, b + shift, c + shift});
  }
  return !geometry::find_self_intersections(all).empty();
}

inline geometry::TriangleSurface ball_at(const Vec3& centre, int levels,
                                         double radius = kBallRadius) {
  auto ball = geometry::make_ball(radius, levels);
  for (Vec3& x : ball.nodes) x += centre;
  return ball;
}

}  // namespace palpate::deformation::testing
