#include "collision/closed_surface.h"

#include <algorithm>
#include <limits>

#include "modules/core/tolerances.h"
#include "modules/geometry/closest_points.h"

namespace palpate::collision {
namespace {

constexpr double kDistanceRounding = 1e-12;  // of a distance

/// A ray from p along an axis, up or down it.
struct Ray {
  Vec3 p;
  int axis = 0;
  bool upwards = true;

  int u() const { return (axis + 1) % 3; }
  int v() const { return (axis + 2) % 3; }
};

/// The shortest way out of the bounds.
Ray ray_out_of(const Bounds& bounds, const Vec3& p) {
  Ray ray{p};
  double shortest = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool upwards : {true, false}) {
      const double way = upwards ? bounds.upper[axis] - p[axis] : p[axis] - bounds.lower[axis];
      if (way >= shortest) continue;
      shortest = way;
      ray.axis = axis;
      ray.upwards = upwards;
    }
  }
  return ray;
}

/// On which side of the line from node a to node b the ray passes: 1 left, −1 right.
int side_of(const Ray& ray, const NodeArray& nodes, std::uint32_t a, std::uint32_t b) {
  if (a > b) return -side_of(ray, nodes, b, a);
  const int u = ray.u(), v = ray.v();
  const double du = nodes[b][u] - nodes[a][u], dv = nodes[b][v] - nodes[a][v];
  const double side = du * (ray.p[v] - nodes[a][v]) - dv * (ray.p[u] - nodes[a][u]);
  if (side != 0) return side > 0 ? 1 : -1;
  if (dv != 0) return dv < 0 ? 1 : -1;
  return du > 0 ? 1 : -1;
}

/// 1 if the ray leaves through the triangle, −1 if it enters, 0 if it misses it.
int crossing_of(const Ray& ray, const NodeArray& nodes, const geometry::Triangle& t) {
  const int turn = side_of(ray, nodes, t[0], t[1]);
  if (side_of(ray, nodes, t[1], t[2]) != turn || side_of(ray, nodes, t[2], t[0]) != turn) return 0;
  const Vec3 normal = (nodes[t[1]] - nodes[t[0]]).cross(nodes[t[2]] - nodes[t[0]]);
  const double height = turn * normal.dot(nodes[t[0]] - ray.p);  // of the triangle over p
  if (ray.upwards) return height > 0 ? turn : 0;
  return height < 0 ? -turn : 0;
}

}  // namespace

bool ClosedSurface::encloses(const OrganSurface& organ, const Vec3& p) {
  const Bounds bounds = organ.bounds();
  Bounds thin;
  thin.add(p);
  if (!bounds.overlaps(thin)) return false;
  const Ray ray = ray_out_of(bounds, p);
  (ray.upwards ? thin.upper : thin.lower)[ray.axis] =
      (ray.upwards ? bounds.upper : bounds.lower)[ray.axis];
  triangles_.clear();
  organ.append_overlapping(thin, triangles_);
  int winding = 0;
  for (const std::uint32_t t : triangles_) {
    winding += crossing_of(ray, organ.positions(), organ.triangles()[t]);
  }
  return winding > 0;
}

/// Fractions of the segment at which a triangle meets it, and its ends, ascending: cuts_. One that
/// is met beside an edge, by rounding, cuts it as well: a cut too many harms nothing.
void ClosedSurface::find_cuts(const OrganSurface& organ, const Vec3& a, const Vec3& b) {
  cuts_.assign({0, 1});
  triangles_.clear();
  organ.append_overlapping({a.cwiseMin(b), a.cwiseMax(b)}, triangles_);
  for (const std::uint32_t t : triangles_) {
    const geometry::TriangleCorners corners = organ.corners(t);
    const Vec3 normal = geometry::unit_normal(corners);
    const double height_a = normal.dot(a - corners[0]), height_b = normal.dot(b - corners[0]);
    if ((height_a > 0) == (height_b > 0)) continue;
    const double at = height_a / (height_a - height_b);
    const Vec3 met = a + at * (b - a);
    const Vec3 nearest = geometry::closest_on_triangle(met, corners).point;
    if ((nearest - met).norm() <= kDirectionless) cuts_.push_back(at);
  }
  std::ranges::sort(cuts_);
}

std::optional<double> ClosedSurface::encloses_at(const OrganSurface& organ, const Vec3& a,
                                                 const Vec3& b) {
  if (encloses(organ, a)) return 0;
  if (a == b) return {};
  if (encloses(organ, b)) return 1;
  find_cuts(organ, a, b);
  std::optional<double> longest;
  double length = 0;
  for (std::size_t i = 1; i < cuts_.size() && cuts_.size() > 2; ++i) {
    const double at = (cuts_[i - 1] + cuts_[i]) / 2;
    if (cuts_[i] - cuts_[i - 1] <= length || !encloses(organ, a + at * (b - a))) continue;
    length = cuts_[i] - cuts_[i - 1];
    longest = at;
  }
  return longest;
}

std::uint32_t ClosedSurface::nearest_triangle(const OrganSurface& organ, const Vec3& p,
                                              double& distance) {
  std::uint32_t nearest = 0;
  distance = std::numeric_limits<double>::infinity();
  const auto visit = [&](std::size_t block) {
    for (const std::uint32_t t : organ.blocks().triangles_of(block)) {
      const geometry::TriangleCorners corners = organ.corners(t);
      if (geometry::unit_normal(corners).isZero(0)) continue;
      const double d = (geometry::closest_on_triangle(p, corners).point - p).norm();
      if (d > distance || (d == distance && t > nearest)) continue;
      distance = d;
      nearest = t;
    }
  };
  // The nearest block first, then those that may hold something as near.
  Bounds point;
  point.add(p);
  block_distances_.clear();
  for (const geometry::BlockBox& box : organ.boxes()) {
    block_distances_.push_back(point.squared_distance(box));
  }
  const auto first = std::min_element(block_distances_.begin(), block_distances_.end());
  const auto first_block = static_cast<std::size_t>(first - block_distances_.begin());
  if (first != block_distances_.end()) visit(first_block);
  for (std::size_t block = 0; block < block_distances_.size(); ++block) {
    const double reach = distance * (1 + kDistanceRounding);
    if (block != first_block && block_distances_[block] <= reach * reach) visit(block);
  }
  return nearest;
}

}  // namespace palpate::collision
