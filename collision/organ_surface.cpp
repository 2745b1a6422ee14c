#include "collision/organ_surface.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "modules/core/error.h"

namespace palpate::collision {

OrganSurface::OrganSurface(std::vector<geometry::Triangle> triangles)
    : triangles_(std::move(triangles)) {
  for (const geometry::Triangle& triangle : triangles_) {
    for (const std::uint32_t node : triangle)
      node_count_ = std::max<std::size_t>(node_count_, node + 1);
  }
  build_node_triangles();
  build_edges();
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

void OrganSurface::update(std::span<const Vec3> positions) {
  PALPATE_DEMAND(positions.size() >= node_count_);
  positions = positions.first(node_count_);
  const bool finite =
      std::all_of(positions.begin(), positions.end(), [](const Vec3& x) { return x.allFinite(); });
  const bool was_present = std::exchange(present_, finite && !triangles_.empty());
  if (!present_) return;
  if (found_ && was_present) {
    std::swap(previous_, positions_);
    previous_version_ = version_;
  } else if (!was_present) {
    previous_version_ = 0;
  }
  found_ = false;
  ++version_;
  positions_.assign(positions.begin(), positions.end());
  double squared = 0;
  for (std::size_t i = 0; previous_version_ > 0 && i < node_count_; ++i) {
    squared = std::max(squared, (positions_[i] - previous_[i]).squaredNorm());
  }
  displacement_ = std::sqrt(squared);
  if (bvh_) {
    bvh_->move(positions_);
  } else {
    bvh_.emplace(positions_, triangles_);
  }
}

const std::vector<Vec3>& OrganSurface::positions_at(std::uint64_t version) const {
  return version > 0 && version == previous_version_ ? previous_ : positions_;
}

double OrganSurface::displacement_since(std::uint64_t version) const {
  return version > 0 && version == previous_version_ ? displacement_ : 0;
}

std::span<const std::uint32_t> OrganSurface::triangles_of_node(std::uint32_t node) const {
  return std::span(node_triangles_)
      .subspan(first_triangle_[node], first_triangle_[node + 1] - first_triangle_[node]);
}

}  // namespace palpate::collision
