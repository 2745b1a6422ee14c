#include "collision/organ_surface.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "modules/core/error.h"

namespace palpate::collision {

OrganSurface::OrganSurface(std::vector<geometry::Triangle> triangles,
                           std::span<const std::uint32_t> block_of_triangle)
    : triangles_(std::move(triangles)) {
  for (const geometry::Triangle& triangle : triangles_) {
    for (const std::uint32_t node : triangle)
      node_count_ = std::max<std::size_t>(node_count_, node + 1);
  }
  build_node_triangles();
  build_edges();
  if (block_of_triangle.empty()) return;
  blocks_ = geometry::SurfaceBlocks(triangles_, block_of_triangle);
}

void OrganSurface::build_node_triangles() {
  first_triangle_.assign(node_count_ + 1, 0);
  for (const geometry::Triangle& triangle : triangles_) {
    for (const std::uint32_t node : triangle) ++first_triangle_[node + 1];
  }
  for (std::size_t i = 0; i < node_count_; ++i) first_triangle_[i + 1] += first_triangle_[i];
  node_triangles_.resize(first_triangle_.back());
  std::vector<std::uint32_t> next = first_triangle_;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    for (const std::uint32_t node : triangles_[t]) node_triangles_[next[node]++] = t;
  }
}

void OrganSurface::build_edges() {
  struct Side {
    std::array<std::uint32_t, 2> nodes;
    std::uint32_t triangle;
    std::uint32_t corner;
  };
  std::vector<Side> sides;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(triangles_[t][k], triangles_[t][(k + 1) % 3]);
      sides.push_back({{a, b}, t, k});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.nodes, a.triangle, a.corner) < std::tie(b.nodes, b.triangle, b.corner);
  });
  edges_of_triangle_.resize(triangles_.size());
  for (const Side& side : sides) {
    if (edges_.empty() || edges_.back().nodes != side.nodes) {
      edges_.push_back({side.nodes, {side.triangle, side.triangle}});
    } else {
      edges_.back().triangles[1] = side.triangle;
    }
    edges_of_triangle_[side.triangle][side.corner] = static_cast<std::uint32_t>(edges_.size() - 1);
  }
}

void OrganSurface::begin_update(bool finite) {
  const bool was_present = std::exchange(present_, finite && !triangles_.empty());
  if (!present_) return;
  if (found_ && was_present) {
    std::swap(previous_, newest_);
    previous_version_ = version_;
  } else if (!was_present) {
    previous_version_ = 0;
  }
  found_ = false;
  ++version_;
}

void OrganSurface::update(std::span<const Vec3> positions) {
  PALPATE_DEMAND(positions.size() >= node_count_);
  positions = positions.first(node_count_);
  begin_update(
      std::all_of(positions.begin(), positions.end(), [](const Vec3& x) { return x.allFinite(); }));
  if (!present_) return;
  newest_.positions.assign(positions);
  if (blocks_.count() == 0) split();
  blocks_.bound(positions, newest_.boxes);
  geometry::bound_groups(newest_.boxes, newest_.groups);
}

void OrganSurface::take(std::vector<float>& positions, Boxes& boxes) {
  PALPATE_DEMAND(positions.size() >= 3 * node_count_);
  const bool told = blocks_.count() > 0 && boxes.size() == blocks_.count();
  const auto end = positions.begin() + 3 * static_cast<std::ptrdiff_t>(node_count_);
  begin_update(told
                   ? geometry::bound_groups(boxes, groups_)
                   : std::all_of(positions.begin(), end, [](float x) { return std::isfinite(x); }));
  if (!present_) return;
  newest_.positions.swap_in(positions);
  if (told) {
    newest_.boxes.swap(boxes);
    newest_.groups.swap(groups_);
    return;
  }
  if (blocks_.count() == 0) split();
  blocks_.bound(newest_.positions.floats(), newest_.boxes);
  geometry::bound_groups(newest_.boxes, newest_.groups);
}

void OrganSurface::split() {
  std::vector<Vec3> nodes(node_count_);
  for (std::uint32_t i = 0; i < node_count_; ++i) nodes[i] = newest_.positions[i];
  blocks_ = {triangles_, geometry::SurfaceBlocks::split(nodes, triangles_)};
}

Bounds OrganSurface::bounds() const {
  Bounds bounds;
  for (const geometry::BlockBox& group : newest_.groups) bounds.add(group);
  return bounds;
}

void OrganSurface::append_overlapping(const Bounds& box,
                                      std::vector<std::uint32_t>& triangles) const {
  const auto overlap = [&](const Boxes& boxes) {
    return [&](std::size_t i) { return box.overlaps(boxes[i]); };
  };
  const auto append = [&](std::size_t block) {
    for (const std::uint32_t t : blocks_.triangles_of(block)) {
      const auto [a, b, c] = corners(t);
      if (box.overlaps({a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)}))
        triangles.push_back(t);
    }
  };
  geometry::visit_blocks(blocks_.count(), overlap(newest_.groups), overlap(newest_.boxes), append);
}

std::span<const std::uint32_t> OrganSurface::triangles_of_node(std::uint32_t node) const {
  return std::span(node_triangles_)
      .subspan(first_triangle_[node], first_triangle_[node + 1] - first_triangle_[node]);
}

}  // namespace palpate::collision
