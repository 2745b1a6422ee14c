#include "visualizer/surface_pick.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/geometry/closest_points.h"

namespace palpate::visualizer {
namespace {

using geometry::TriangleCorners;

constexpr double kFar = 100;  // further away nothing is picked [m]

TriangleCorners corners(const OrganView& organ, const TriangleIndices& t) {
  return {organ.node(t[0]), organ.node(t[1]), organ.node(t[2])};
}

/// Part of the way from `from` along `way` at which it meets the triangle (Möller and Trumbore,
/// J. Graphics Tools 2, 1997); infinity if it does not.
double meets(const Vec3& from, const Vec3& way, const TriangleCorners& triangle) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const Vec3 a = triangle[1] - triangle[0], b = triangle[2] - triangle[0];
  const Vec3 across = way.cross(b);
  const double det = a.dot(across);
  if (det == 0) return kNever;
  const Vec3 to = from - triangle[0];
  const double u = to.dot(across) / det;
  if (!(u >= 0 && u <= 1)) return kNever;
  const Vec3 turned = to.cross(a);
  const double v = way.dot(turned) / det;
  if (!(v >= 0 && u + v <= 1)) return kNever;
  const double part = b.dot(turned) / det;
  return part >= 0 && part <= 1 ? part : kNever;
}

std::uint32_t nearest_node(const OrganView& organ, const Vec3& p, double& least) {
  std::uint32_t nearest = 0;
  least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < organ.surface.surface_node_count; ++i) {
    const double distance = (organ.node(i) - p).squaredNorm();
    if (distance < least) {
      least = distance;
      nearest = i;
    }
  }
  return nearest;
}

}  // namespace

std::optional<SurfacePoint> first_on_way(const SceneView& view, const Vec3& from, const Vec3& to) {
  std::optional<SurfacePoint> first;
  double least = std::numeric_limits<double>::infinity();
  const Vec3 way = to - from;
  for (std::size_t i = 0; i < view.organs().size(); ++i) {
    const OrganView& organ = view.organs()[i];
    for (const TriangleIndices& t : organ.surface.triangles) {
      const TriangleCorners triangle = corners(organ, t);
      const double part = meets(from, way, triangle);
      if (!(part < least)) continue;
      least = part;
      first = SurfacePoint{i, from + part * way, geometry::unit_normal(triangle)};
    }
  }
  return first;
}

std::optional<SurfacePoint> pick_surface(const SceneView& view, const Camera& camera, double x,
                                         double y) {
  return first_on_way(view, camera.position, unproject(camera, {x, y, kFar}));
}

std::optional<SurfacePoint> foot_on_surface(const SceneView& view, const Vec3& p) {
  std::optional<SurfacePoint> foot;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < view.organs().size(); ++i) {
    const OrganView& organ = view.organs()[i];
    double to_node = 0;
    const std::uint32_t node = nearest_node(organ, p, to_node);
    if (!(to_node < 4 * least)) continue;
    for (const TriangleIndices& t : organ.surface.triangles) {
      if (std::find(t.begin(), t.end(), node) == t.end()) continue;
      const TriangleCorners triangle = corners(organ, t);
      const Vec3 normal = geometry::unit_normal(triangle);
      if (normal.isZero()) continue;
      const Vec3 point = geometry::closest_on_triangle(p, triangle).point;
      const double distance = (point - p).squaredNorm();
      if (!(distance < least)) continue;
      least = distance;
      foot = SurfacePoint{i, point, normal};
    }
  }
  return foot;
}

}  // namespace palpate::visualizer
