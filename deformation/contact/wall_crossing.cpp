#include "deformation/contact/wall_crossing.h"

#include <algorithm>
#include <cmath>

#include "modules/geometry/continuous_collision.h"

namespace palpate::deformation {
namespace {

/// Beneath a plane is what is above it by less than this part of its distance: flat walls.
constexpr double kFlat = 1e-6;

Vec3 between(const Vec3& from, const Vec3& to, double share) { return from + share * (to - from); }

/// Of a line across an edge of the wall: outward, with both triangles beneath; zero if there is
/// none.
Vec3 normal_over_edge(const Vec3& line, const EdgeCorners& at) {
  const auto& [p, q, r, s] = at;
  Vec3 normal = (q - p).cross(line).normalized();
  if (normal.dot((q - p).cross(r - p)) < 0) normal = -normal;
  const auto beneath = [&](const Vec3& x) { return normal.dot(x - p) <= kFlat * (x - p).norm(); };
  return beneath(r) && beneath(s) ? normal : Vec3::Zero();
}

}  // namespace

double CoreWay::length() const { return std::max((a1 - a0).norm(), (b1 - b0).norm()); }

std::optional<WallCrossing> crossing_of_point(const geometry::TriangleCorners& start,
                                              const geometry::TriangleCorners& end) {
  const Vec3 p = Vec3::Zero();
  const auto impact = geometry::point_triangle_impact({p, start[0], start[1], start[2]},
                                                      {p, end[0], end[1], end[2]});
  if (!impact) return {};
  WallCrossing crossing;
  crossing.time = impact->time;
  const double u = impact->u, v = std::min(impact->v, 1 - impact->u);
  crossing.weights = {1 - u - v, u, v};
  geometry::TriangleCorners at;
  Vec3 way = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    at[k] = start[k] + impact->time * (end[k] - start[k]);
    way += crossing.weights[k] * (end[k] - start[k]);
  }
  crossing.normal = geometry::unit_normal(at);
  if (!(crossing.normal.dot(way) > 0)) return {};  // the wall comes from behind
  return crossing;
}

std::optional<WallCrossing> crossing_of_side(const CoreWay& core, const EdgeCorners& start,
                                             const EdgeCorners& end) {
  const auto impact = geometry::edge_edge_impact({core.a0, core.b0, start[0], start[1]},
                                                 {core.a1, core.b1, end[0], end[1]});
  if (!impact) return {};
  WallCrossing crossing;
  crossing.time = impact->time;
  crossing.along = impact->u;
  crossing.weights = {1 - impact->v, impact->v, 0};
  EdgeCorners at;
  for (std::size_t k = 0; k < at.size(); ++k) at[k] = between(start[k], end[k], impact->time);
  const Vec3 line =
      between(core.b0, core.b1, impact->time) - between(core.a0, core.a1, impact->time);
  crossing.normal = normal_over_edge(line, at);
  const Vec3 wall = between(end[0] - start[0], end[1] - start[1], impact->v);
  const Vec3 probe = between(core.a1 - core.a0, core.b1 - core.b0, impact->u);
  if (!(crossing.normal.dot(wall - probe) > 0)) return {};  // or it goes away from it
  return crossing;
}

}  // namespace palpate::deformation
