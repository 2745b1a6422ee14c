#include "collision/near_features.h"

#include <algorithm>
#include <limits>

#include "modules/core/error.h"
#include "modules/geometry/closest_points.h"
#include "modules/geometry/self_intersection.h"

namespace palpate::collision {
namespace {

/// Small blocks: each with itself is a look at every pair of its features.
constexpr std::size_t kBlockTriangles = 24;

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
  const double before = geometry::gap_along(at_start.direction, first_count, start);
  const double after = geometry::gap_along(at_start.direction, first_count, end);
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

void NearFeatures::make_blocks(std::span<const std::span<const Vec3>> positions) {
  features_.resize(surfaces_.size());
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const auto& triangles = surfaces_[i].triangles();
    const auto block = geometry::SurfaceBlocks::split(positions[i], triangles, kBlockTriangles);
    surfaces_[i] = OrganSurface(triangles, block);
    const std::size_t blocks = surfaces_[i].blocks().count();
    features_[i].nodes.resize(blocks);
    features_[i].edges.resize(blocks);
    for (std::uint32_t node = 0; node < surfaces_[i].node_count(); ++node) {
      const auto around = surfaces_[i].triangles_of_node(node);
      if (!around.empty()) features_[i].nodes[block[around.front()]].push_back(node);
    }
    for (std::uint32_t e = 0; e < surfaces_[i].edges().size(); ++e) {
      features_[i].edges[block[surfaces_[i].edges()[e].triangles[0]]].push_back(e);
    }
  }
}

void NearFeatures::search(std::span<const std::span<const Vec3>> positions, double reach) {
  PALPATE_DEMAND(positions.size() == surfaces_.size());
  if (features_.empty()) make_blocks(positions);
  for (std::size_t i = 0; i < surfaces_.size(); ++i) surfaces_[i].update(positions[i]);
  pairs_.clear();
  for (std::uint32_t a = 0; a < surfaces_.size(); ++a) {
    for (std::uint32_t b = a; b < surfaces_.size(); ++b) {
      if (!may_touch(a, b) || !surfaces_[a].present() || !surfaces_[b].present()) continue;
      search_pair(a, b, reach);
    }
  }
  std::sort(pairs_.begin(), pairs_.end(),
            [](const NearPair& a, const NearPair& b) { return a.pair < b.pair; });
}

/// Blocks whose boxes come within reach, found by a sweep along x.
void NearFeatures::search_pair(std::uint32_t first, std::uint32_t second, double reach) {
  along_x_.clear();
  for (const std::uint32_t surface : {first, second}) {
    const auto& boxes = surfaces_[surface].boxes();
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      along_x_.push_back({boxes[i].lower[0] - reach, {surface, i}});
    }
    if (first == second) break;
  }
  std::sort(along_x_.begin(), along_x_.end(),
            [](const BlockAlongX& a, const BlockAlongX& b) { return a.lower < b.lower; });
  for (std::size_t i = 0; i < along_x_.size(); ++i) {
    const Bounds box = box_of(along_x_[i].block, reach);
    for (std::size_t k = i; k < along_x_.size() && along_x_[k].lower <= box.upper[0]; ++k) {
      Block one = along_x_[i].block, other = along_x_[k].block;
      if (first != second && one.surface == other.surface) continue;
      if (!box.overlaps(box_of(other, 0))) continue;
      if (other.surface < one.surface) std::swap(one, other);
      add_nodes(one, other, reach);
      if (i != k) add_nodes(other, one, reach);
      add_edges(one, other, reach);
    }
  }
}

Bounds NearFeatures::box_of(const Block& block, double reach) const {
  Bounds box;
  box.add(surfaces_[block.surface].boxes()[block.index]);
  box.inflate(reach);
  return box;
}

void NearFeatures::list_nodes(const Block& of, const Bounds& within, double reach) {
  ones_.clear();
  for (const std::uint32_t node : features_[of.surface].nodes[of.index]) {
    const Vec3 x = surfaces_[of.surface].positions()[node];
    const Bounds box = bounds_of(x, x, reach);
    if (box.overlaps(within)) ones_.push_back({node, box});
  }
}

void NearFeatures::list_triangles(const Block& of, const Bounds& within) {
  others_.clear();
  for (const std::uint32_t t : surfaces_[of.surface].blocks().triangles_of(of.index)) {
    const auto [a, b, c] = surfaces_[of.surface].corners(t);
    Bounds box = bounds_of(a, b, 0);
    box.add(c);
    if (box.overlaps(within)) others_.push_back({t, box});
  }
}

void NearFeatures::list_edges(const Block& of, const Bounds& within, double reach,
                              std::vector<Boxed>& list) {
  list.clear();
  const OrganSurface& surface = surfaces_[of.surface];
  for (const std::uint32_t edge : features_[of.surface].edges[of.index]) {
    const auto [a, b] = surface.edges()[edge].nodes;
    const Bounds box = bounds_of(surface.positions()[a], surface.positions()[b], reach);
    if (box.overlaps(within)) list.push_back({edge, box});
  }
}

void NearFeatures::add_nodes(const Block& of, const Block& with, double reach) {
  list_nodes(of, box_of(with, 0), reach);
  if (ones_.empty()) return;
  list_triangles(with, box_of(of, reach));
  for (const Boxed& node : ones_) {
    for (const Boxed& other : others_) {
      if (!node.box.overlaps(other.box)) continue;
      const geometry::Triangle& t = surfaces_[with.surface].triangles()[other.index];
      if (of.surface == with.surface && has_node(t, node.index)) continue;
      add_if_near({{of.surface, with.surface}, false, {node.index, t[0], t[1], t[2]}}, reach);
    }
  }
}

void NearFeatures::add_edges(const Block& first, const Block& second, double reach) {
  const bool same_surface = first.surface == second.surface;
  const bool same_block = same_surface && first.index == second.index;
  list_edges(first, box_of(second, 0), reach, ones_);
  if (ones_.empty()) return;
  list_edges(second, box_of(first, reach), 0, others_);
  for (const Boxed& one : ones_) {
    for (const Boxed& other : others_) {
      if (!one.box.overlaps(other.box) || (same_block && other.index <= one.index)) continue;
      auto [a, b] = surfaces_[first.surface].edges()[one.index].nodes;
      auto [c, d] = surfaces_[second.surface].edges()[other.index].nodes;
      if (same_surface && (a == c || a == d || b == c || b == d)) continue;
      if (same_surface && other.index < one.index) {
        std::swap(a, c);
        std::swap(b, d);
      }
      add_if_near({{first.surface, second.surface}, true, {a, b, c, d}}, reach);
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
  const auto of_a = a.positions().doubles(), of_b = b.positions().doubles();
  std::vector<Vec3> nodes(of_a.begin(), of_a.end());
  if (shift > 0) nodes.insert(nodes.end(), of_b.begin(), of_b.end());
  std::vector<std::uint32_t> near;
  for (std::uint32_t t = 0; t < a.triangles().size(); ++t) {
    const geometry::Triangle& triangle = a.triangles()[t];
    Bounds box = bounds_of(nodes[triangle[0]], nodes[triangle[1]], 0);
    box.add(nodes[triangle[2]]);
    near.clear();
    b.append_overlapping(box, near);
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
