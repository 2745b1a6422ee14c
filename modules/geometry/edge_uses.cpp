#include "modules/geometry/edge_uses.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "modules/core/sort_unique.h"

namespace palpate::geometry {

std::vector<EdgeUse> edge_uses_of(std::span<const Triangle> triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t from = triangles[t][i], to = triangles[t][(i + 1) % 3];
      if (from != to) uses.push_back({std::min(from, to), std::max(from, to), t, from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& x, const EdgeUse& y) {
    return std::tie(x.a, x.b, x.triangle) < std::tie(y.a, y.b, y.triangle);
  });
  return uses;
}

std::vector<std::vector<std::uint32_t>> neighbours_of(
    std::size_t node_count, std::span<const std::array<std::uint32_t, 2>> edges) {
  std::vector<std::vector<std::uint32_t>> neighbours(node_count);
  for (const auto& [a, b] : edges) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  return neighbours;
}

std::vector<std::array<std::uint32_t, 2>> second_neighbours_of(
    std::span<const std::vector<std::uint32_t>> neighbours, std::size_t most) {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  std::vector<std::uint32_t> second_ring;
  for (std::uint32_t a = 0; a < neighbours.size() && pairs.size() <= most; ++a) {
    second_ring.clear();
    for (const std::uint32_t middle : neighbours[a]) {
      for (const std::uint32_t b : neighbours[middle]) {
        if (b > a && !std::binary_search(neighbours[a].begin(), neighbours[a].end(), b)) {
          second_ring.push_back(b);
        }
      }
    }
    sort_unique(second_ring);
    for (const std::uint32_t b : second_ring) pairs.push_back({a, b});
  }
  return pairs;
}

DisjointSets::DisjointSets(std::size_t count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), 0u);
}

std::uint32_t DisjointSets::root(std::uint32_t item) {
  while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
  return item;
}

// The smaller index becomes the root, so that roots do not depend on the order of joining.
void DisjointSets::join(std::uint32_t a, std::uint32_t b) {
  a = root(a);
  b = root(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

}  // namespace palpate::geometry
