#include "deformation/contact/surface_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "modules/core/tolerances.h"

namespace palpate::deformation {
namespace {

geometry::TriangleCorners corners_of(const geometry::Triangle& t, std::span<const Vec3> x) {
  return {x[t[0]], x[t[1]], x[t[2]]};
}

geometry::SegmentAndTriangle closest(const Vec3& a, const Vec3& b,
                                     const geometry::TriangleCorners& corners) {
  if (a != b) return geometry::closest_of_segment_and_triangle(a, b, corners);
  const geometry::PointOnTriangle on_triangle = geometry::closest_on_triangle(a, corners);
  return {a, on_triangle, (a - on_triangle.point).norm()};
}

/// May the origin meet what is between these corners, each going from the one to the other?
bool may_meet(const geometry::TriangleCorners& start, const geometry::TriangleCorners& end) {
  Vec3 low = start[0], high = start[0];
  for (int k = 0; k < 3; ++k) {
    low = low.cwiseMin(start[k]).cwiseMin(end[k]);
    high = high.cwiseMax(start[k]).cwiseMax(end[k]);
  }
  return (low.array() <= kDirectionless).all() && (high.array() >= -kDirectionless).all();
}

/// Do the boxes around what a core and a triangle pass overlap?
bool may_meet(const CoreWay& core, const geometry::TriangleCorners& start,
              const geometry::TriangleCorners& end) {
  const Vec3 low = core.a0.cwiseMin(core.b0).cwiseMin(core.a1).cwiseMin(core.b1);
  const Vec3 high = core.a0.cwiseMax(core.b0).cwiseMax(core.a1).cwiseMax(core.b1);
  Vec3 wall_low = start[0], wall_high = start[0];
  for (int k = 0; k < 3; ++k) {
    wall_low = wall_low.cwiseMin(start[k]).cwiseMin(end[k]);
    wall_high = wall_high.cwiseMax(start[k]).cwiseMax(end[k]);
  }
  return (wall_low.array() <= high.array() + kDirectionless).all() &&
         (low.array() <= wall_high.array() + kDirectionless).all();
}

/// Is a triangle's box within `reach` of the core's?
bool may_touch(const Vec3& a, const Vec3& b, const geometry::TriangleCorners& x, double reach) {
  const Vec3 low = a.cwiseMin(b), high = a.cwiseMax(b);
  const Vec3 wall_low = x[0].cwiseMin(x[1]).cwiseMin(x[2]);
  const Vec3 wall_high = x[0].cwiseMax(x[1]).cwiseMax(x[2]);
  return (wall_low.array() <= high.array() + reach).all() &&
         (low.array() <= wall_high.array() + reach).all();
}

/// Is a triangle's box further than `reach` from the core's? Much less than closest() costs; most
/// triangles that a walk meets are.
bool is_beyond(const Vec3& a, const Vec3& b, const geometry::TriangleCorners& x, double reach) {
  constexpr double kAbove = 1 + 1e-9;  // closest() rounds
  const Vec3 wall_low = x[0].cwiseMin(x[1]).cwiseMin(x[2]);
  const Vec3 wall_high = x[0].cwiseMax(x[1]).cwiseMax(x[2]);
  const Vec3 apart = (wall_low - a.cwiseMax(b)).cwiseMax(a.cwiseMin(b) - wall_high).cwiseMax(0);
  return apart.squaredNorm() > kAbove * reach * reach + kDirectionless * kDirectionless;
}

double farthest_corner(const geometry::TriangleCorners& from, const geometry::TriangleCorners& to) {
  double moved = 0;
  for (int k = 0; k < 3; ++k) moved = std::max(moved, (to[k] - from[k]).norm());
  return moved;
}

}  // namespace

SurfaceWalk::SurfaceWalk(const Body& body) : body_(body) {
  first_triangle_.assign(body.surface_node_count + 1, 0);
  for (const geometry::Triangle& t : body.triangles) {
    for (const std::uint32_t node : t) ++first_triangle_[node + 1];
  }
  for (std::size_t i = 1; i < first_triangle_.size(); ++i)
    first_triangle_[i] += first_triangle_[i - 1];
  node_triangles_.resize(first_triangle_.back());
  std::vector<std::uint32_t> next = first_triangle_;
  for (std::uint32_t t = 0; t < body.triangles.size(); ++t) {
    for (const std::uint32_t node : body.triangles[t]) node_triangles_[next[node]++] = t;
  }
  visited_.assign(body.triangles.size(), 0);
}

std::span<const std::uint32_t> SurfaceWalk::around(std::uint32_t node) const {
  return std::span(node_triangles_)
      .subspan(first_triangle_[node], first_triangle_[node + 1] - first_triangle_[node]);
}

NearTriangle SurfaceWalk::triangle_near(std::uint32_t triangle, const Vec3& a, const Vec3& b,
                                        std::span<const Vec3> positions) const {
  const auto corners = corners_of(body_.triangles[triangle], positions);
  NearTriangle near{triangle, closest(a, b, corners)};
  if (near.pair.distance > kDirectionless) {
    near.away = (near.pair.on_segment - near.pair.on_triangle.point) / near.pair.distance;
    near.facing = near.away.dot(geometry::unit_normal(corners));
  }
  return near;
}

template <class Take>
void SurfaceWalk::flood(std::span<const std::uint32_t> first, const Take& take) {
  ++walk_;
  waiting_.clear();
  const auto visit = [&](std::uint32_t t) {
    if (std::exchange(visited_[t], walk_) != walk_ && take(t)) waiting_.push_back(t);
  };
  for (const std::uint32_t t : first) visit(t);
  while (!waiting_.empty()) {
    const geometry::Triangle nodes = body_.triangles[waiting_.back()];
    waiting_.pop_back();
    for (const std::uint32_t node : nodes) {
      for (const std::uint32_t t : around(node)) visit(t);
    }
  }
}

std::uint32_t SurfaceWalk::nearest_from(const Vec3& a, const Vec3& b,
                                        std::span<const Vec3> positions,
                                        std::span<const std::uint32_t> seeds) {
  std::uint32_t nearest = 0;
  double distance = std::numeric_limits<double>::infinity();
  ++walk_;
  bool nearer = false;
  const auto visit = [&](std::uint32_t t) {
    if (std::exchange(visited_[t], walk_) == walk_) return;
    const auto corners = corners_of(body_.triangles[t], positions);
    if (is_beyond(a, b, corners, distance)) return;
    const double d = closest(a, b, corners).distance;
    if (!(d < distance)) return;
    distance = d;
    nearest = t;
    nearer = true;
  };
  for (const std::uint32_t t : seeds) visit(t);
  while (std::exchange(nearer, false)) {
    const geometry::Triangle nodes = body_.triangles[nearest];
    for (const std::uint32_t node : nodes) {
      for (const std::uint32_t t : around(node)) visit(t);
    }
  }
  return nearest;
}

std::uint32_t SurfaceWalk::nearest_node(const Vec3& a, const Vec3& b,
                                        std::span<const Vec3> positions) const {
  const Vec3 along = b - a;
  const double length = std::max(along.squaredNorm(), kDirectionless * kDirectionless);
  std::uint32_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < body_.surface_node_count; ++i) {
    const Vec3 from_a = positions[i] - a;
    const double at = std::clamp(from_a.dot(along) / length, 0.0, 1.0);
    const double squared = (from_a - at * along).squaredNorm();
    if (squared >= least) continue;
    least = squared;
    nearest = i;
  }
  return nearest;
}

void SurfaceWalk::find(const Vec3& a, const Vec3& b, std::span<const Vec3> positions,
                       std::span<const std::uint32_t> seeds, double reach,
                       std::vector<NearTriangle>& near) {
  near.clear();
  if (seeds.empty()) return;
  const std::uint32_t nearest = nearest_from(a, b, positions, seeds);
  first_.assign(seeds.begin(), seeds.end());
  first_.push_back(nearest);
  flood(first_, [&](std::uint32_t t) {
    const bool may_be_near =
        t == nearest || !is_beyond(a, b, corners_of(body_.triangles[t], positions), reach);
    if (!may_be_near) return false;
    const NearTriangle found = triangle_near(t, a, b, positions);
    if (t != nearest && !(found.pair.distance <= reach)) return false;
    near.push_back(found);
    return true;
  });
  std::ranges::sort(near, {}, &NearTriangle::index);
}

void SurfaceWalk::append_near(const Vec3& a, const Vec3& b, std::span<const Vec3> positions,
                              double reach, std::vector<std::uint32_t>& near) const {
  for (std::uint32_t t = 0; t < body_.triangles.size(); ++t) {
    const auto corners = corners_of(body_.triangles[t], positions);
    if (may_touch(a, b, corners, reach) && closest(a, b, corners).distance <= reach)
      near.push_back(t);
  }
}

bool SurfaceWalk::is_cut(const Vec3& a, const Vec3& b, std::span<const Vec3> positions,
                         std::span<const std::uint32_t> seeds, double reach) {
  bool cut = false;
  flood(seeds, [&](std::uint32_t t) {
    const auto corners = corners_of(body_.triangles[t], positions);
    if (cut || !may_touch(a, b, corners, reach)) return false;
    if (!may_touch(a, b, corners, 0)) return true;
    const auto pair = closest(a, b, corners);
    cut = pair.distance == 0 && fixed_yielding(body_, t, pair.on_triangle.weights) == 0;
    return !cut;
  });
  return cut;
}

std::optional<WallCrossing> SurfaceWalk::first_crossing(const Vec3& p0, const Vec3& p1,
                                                        std::span<const Vec3> start,
                                                        std::span<const Vec3> end,
                                                        std::span<const std::uint32_t> seeds) {
  std::optional<WallCrossing> first;
  const double way = (p1 - p0).norm();
  flood(seeds, [&](std::uint32_t t) {
    geometry::TriangleCorners from = corners_of(body_.triangles[t], start);
    geometry::TriangleCorners to = corners_of(body_.triangles[t], end);
    const double moved = farthest_corner(from, to);
    for (int k = 0; k < 3; ++k) {
      from[k] -= p0;
      to[k] -= p1;
    }
    if (is_beyond(Vec3::Zero(), Vec3::Zero(), from, way + moved)) return false;
    const double distance = geometry::closest_on_triangle(Vec3::Zero(), from).point.norm();
    if (distance > way + moved) return false;
    if (!may_meet(from, to)) return true;
    const auto crossing = crossing_of_point(from, to);
    if (crossing &&
        (!first || std::pair(crossing->time, t) < std::pair(first->time, first->triangle))) {
      first = crossing;
      first->triangle = t;
    }
    return true;
  });
  return first;
}

std::uint32_t SurfaceWalk::opposite_of(std::uint32_t p, std::uint32_t q,
                                       std::uint32_t triangle) const {
  for (const std::uint32_t other : around(p)) {
    const geometry::Triangle& t = body_.triangles[other];
    if (other == triangle || std::ranges::count(t, q) == 0) continue;
    for (const std::uint32_t node : t) {
      if (node != p && node != q) return node;
    }
  }
  return p;
}

void SurfaceWalk::find_side_crossings(const CoreWay& core, std::span<const Vec3> start,
                                      std::span<const Vec3> end,
                                      std::span<const std::uint32_t> seeds,
                                      std::vector<WallCrossing>& crossings) {
  crossings.clear();
  const double way = core.length();
  flood(seeds, [&](std::uint32_t t) {
    const geometry::Triangle nodes = body_.triangles[t];
    const auto from = corners_of(nodes, start), to = corners_of(nodes, end);
    const double reach = way + farthest_corner(from, to);
    if (is_beyond(core.a0, core.b0, from, reach)) return false;
    if (closest(core.a0, core.b0, from).distance > reach) return false;
    if (!may_meet(core, from, to)) return true;
    std::optional<WallCrossing> first;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t p = nodes[k], q = nodes[(k + 1) % 3], r = nodes[(k + 2) % 3];
      if (p > q) continue;  // each edge once: the other triangle has it the other way round
      const std::uint32_t s = opposite_of(p, q, t);
      const auto crossing = crossing_of_side(core, {start[p], start[q], start[r], start[s]},
                                             {end[p], end[q], end[r], end[s]});
      if (!crossing || (first && first->time <= crossing->time)) continue;
      first = crossing;
      for (std::size_t i = 0; i < 3; ++i) first->weights[(k + i) % 3] = crossing->weights[i];
    }
    if (first) crossings.emplace_back(*first).triangle = t;
    return true;
  });
  std::ranges::sort(crossings, {}, &WallCrossing::triangle);
}

bool is_behind_nearest(std::span<const NearTriangle> near) {
  constexpr double kEquallyNear = 1e-9;  // [m]
  double nearest = std::numeric_limits<double>::infinity(), facing = 0;
  for (const NearTriangle& n : near) nearest = std::min(nearest, n.pair.distance);
  for (const NearTriangle& n : near) {
    if (n.pair.distance > nearest + kEquallyNear) continue;
    if (std::abs(n.facing) > std::abs(facing)) facing = n.facing;
  }
  return facing < 0;
}

}  // namespace palpate::deformation
