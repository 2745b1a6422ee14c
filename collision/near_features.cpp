#include "collision/near_features.h"

#include <algorithm>
#include <limits>

#include "modules/core/error.h"
#include "modules/geometry/closest_points.h"
#include "modules/geometry/self_intersection.h"

namespace palpate::collision {
namespace {

Separation between(const Vec3& first, const Vec3& second, const std::array<double, 4>& weights) {
  const Vec3 way = second - first;
  const double distance = way.norm();
  return {distance, distance > 0 ? Vec3(way / distance) : Vec3(Vec3::Zero()), weights};
}

/// To the nearest of a triangle's sides, which a triangle without area is.
Separation of_node_and_sides(const FourPoints& x) {
  Separation best;
  best.distance = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const int a = 1 + k, b = 1 + (k + 1) % 3;
    const auto closest = geometry::closest_of_segments(x[0], x[0], x[a], x[b]);
    std::array<double, 4> weights{1, 0, 0, 0};
    weights[a] = 1 - closest.t;
    weights[b] = closest.t;
    const Separation side = between(x[0], closest.on_second, weights);
    if (side.distance < best.distance) best = side;
  }
  return best;
}

Bounds bounds_of(const Vec3& a, const Vec3& b, double reach) {
  Bounds box;
  box.add(a);
  box.add(b);
  box.inflate(reach);
  return box;
}

bool has_node(const geometry::Triangle& triangle, std::uint32_t node) {
  return std::find(triangle.begin(), triangle.end(), node) != triangle.end();
}

/// How far the second side is beyond the first along a direction [m].
double gap_along(const Vec3& direction, std::size_t first_count, const FourPoints& x) {
  double first = -std::numeric_limits<double>::infinity(), second = -first;
  for (std::size_t k = 0; k < x.size(); ++k) {
    // About a node of the pair, so that pairs far from the origin keep their digits.
    const double height = direction.dot(x[k] - x[0]);
    if (k < first_count) {
      first = std::max(first, height);
    } else {
      second = std::min(second, height);
    }
  }
  return second - first;
}

}  // namespace

Separation separation_of(bool is_edges, const FourPoints& x) {
  if (is_edges) {
    const auto closest = geometry::closest_of_segments(x[0], x[1], x[2], x[3]);
    return between(closest.on_first, closest.on_second,
                   {1 - closest.s, closest.s, 1 - closest.t, closest.t});
  }
  const auto closest = geometry::closest_on_triangle(x[0], {x[1], x[2], x[3]});
  if (!closest.point.allFinite()) return of_node_and_sides(x);
  const Vec3& w = closest.weights;
  return between(x[0], closest.point, {1, w[0], w[1], w[2]});
}

bool stays_apart(bool is_edges, const FourPoints& start, const FourPoints& end,
                 const Separation& at_start, double least) {
  const std::size_t first_count = is_edges ? 2 : 1;
  const double before = gap_along(at_start.direction, first_count, start);
  const double after = gap_along(at_start.direction, first_count, end);
  if (before > 0 && after >= std::min(before, least)) return true;
  const auto impact = is_edges ? geometry::edge_edge_impact(start, end, least)
                               : geometry::point_triangle_impact(start, end, least);
  return !impact;
}

NearFeatures::NearFeatures(std::vector<std::vector<geometry::Triangle>> triangles,
                           const TouchingKinds& kinds)
    : kinds_(kinds) {
  for (auto& of_surface : triangles) surfaces_.emplace_back(std::move(of_surface));
}

void NearFeatures::search(std::span<const std::span<const Vec3>> positions, double reach) {
  PALPATE_DEMAND(positions.size() == surfaces_.size());
  for (std::size_t i = 0; i < surfaces_.size(); ++i) surfaces_[i].update(positions[i]);
  pairs_.clear();
  for (std::uint32_t a = 0; a < surfaces_.size(); ++a) {
    for (std::uint32_t b = a; b < surfaces_.size(); ++b) {
      if (!may_touch(a, b) || !surfaces_[a].present() || !surfaces_[b].present()) continue;
      add_nodes(a, b, reach);
      if (a != b) add_nodes(b, a, reach);
      add_edges(a, b, reach);
    }
  }
  std::sort(pairs_.begin(), pairs_.end(),
            [](const NearPair& a, const NearPair& b) { return a.pair < b.pair; });
}

void NearFeatures::add_nodes(std::uint32_t of, std::uint32_t with, double reach) {
  const OrganSurface &first = surfaces_[of], &second = surfaces_[with];
  const Bounds whole = second.bvh().bounds();
  for (std::uint32_t node = 0; node < first.positions().size(); ++node) {
    if (first.triangles_of_node(node).empty()) continue;
    const Vec3& x = first.positions()[node];
    const Bounds box = bounds_of(x, x, reach);
    if (!box.overlaps(whole)) continue;
    list_.clear();
    second.bvh().append_overlapping(box, list_);
    for (const std::uint32_t t : list_) {
      const geometry::Triangle& triangle = second.triangles()[t];
      if (of == with && has_node(triangle, node)) continue;
      add_if_near({{of, with}, false, {node, triangle[0], triangle[1], triangle[2]}}, reach);
    }
  }
}

void NearFeatures::add_edges(std::uint32_t of, std::uint32_t with, double reach) {
  const OrganSurface &first = surfaces_[of], &second = surfaces_[with];
  const Bounds whole = second.bvh().bounds();
  for (std::uint32_t e = 0; e < first.edges().size(); ++e) {
    const auto [a, b] = first.edges()[e].nodes;
    const Bounds box = bounds_of(first.positions()[a], first.positions()[b], reach);
    if (!box.overlaps(whole)) continue;
    list_.clear();
    second.bvh().append_overlapping(box, list_);
    for (const std::uint32_t t : list_) {
      for (const std::uint32_t f : second.edges_of_triangle(t)) {
        const SurfaceEdge& other = second.edges()[f];
        // Once, with the first of its triangles.
        if (other.triangles[0] != t || (of == with && f <= e)) continue;
        const auto [c, d] = other.nodes;
        if (!box.overlaps(bounds_of(second.positions()[c], second.positions()[d], 0))) continue;
        if (of == with && (a == c || a == d || b == c || b == d)) continue;
        add_if_near({{of, with}, true, {a, b, c, d}}, reach);
      }
    }
  }
}

void NearFeatures::add_if_near(const FeaturePair& pair, double reach) {
  FourPoints x;
  for (std::size_t k = 0; k < x.size(); ++k) {
    x[k] = surfaces_[pair.surface_of(k)].positions()[pair.nodes[k]];
  }
  const double distance = separation_of(pair.is_edges, x).distance;
  if (distance <= reach) pairs_.push_back({pair, distance});
}

bool NearFeatures::cross(std::uint32_t first, std::uint32_t second) const {
  const OrganSurface &a = surfaces_[first], &b = surfaces_[second];
  const auto shift = static_cast<std::uint32_t>(first == second ? 0 : a.positions().size());
  std::vector<Vec3> nodes = a.positions();
  if (shift > 0) nodes.insert(nodes.end(), b.positions().begin(), b.positions().end());
  std::vector<std::uint32_t> near;
  for (std::uint32_t t = 0; t < a.triangles().size(); ++t) {
    const geometry::Triangle& triangle = a.triangles()[t];
    Bounds box = bounds_of(nodes[triangle[0]], nodes[triangle[1]], 0);
    box.add(nodes[triangle[2]]);
    near.clear();
    b.bvh().append_overlapping(box, near);
    for (const std::uint32_t u : near) {
      if (first == second && u <= t) continue;
      geometry::Triangle other = b.triangles()[u];
      for (std::uint32_t& node : other) node += shift;
      if (geometry::triangles_intersect(nodes, triangle, other)) return true;
    }
  }
  return false;
}

std::optional<std::array<std::uint32_t, 2>> NearFeatures::first_crossing() const {
  for (std::uint32_t a = 0; a < surfaces_.size(); ++a) {
    for (std::uint32_t b = a; b < surfaces_.size(); ++b) {
      if (!may_touch(a, b) || !surfaces_[a].present() || !surfaces_[b].present()) continue;
      if (cross(a, b)) return {{a, b}};
    }
  }
  return {};
}

}  // namespace palpate::collision
