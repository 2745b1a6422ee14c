// Lists which triangles use each edge, and in which direction; which nodes edges join.
#pragma once

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

struct EdgeUse {
  std::uint32_t a = 0, b = 0;  ///< the edge's nodes, a < b
  std::uint32_t triangle = 0;
  bool forward = true;  ///< the triangle runs from a to b

  bool same_edge(const EdgeUse& other) const { return a == other.a && b == other.b; }
};

/// Every use of every edge, sorted by (a, b, triangle). Sides from a node to itself are
/// left out.
std::vector<EdgeUse> edge_uses_of(std::span<const Triangle> triangles);

/// Calls `visit(span of the uses)` for every edge, in order.
template <typename Visit>
void for_each_edge(std::span<const EdgeUse> uses, Visit visit) {
  for (std::size_t begin = 0; begin < uses.size();) {
    std::size_t end = begin + 1;
    while (end < uses.size() && uses[end].same_edge(uses[begin])) ++end;
    visit(uses.subspan(begin, end - begin));
    begin = end;
  }
}

/// The other ends of each node's edges, ascending if the edges are sorted as by edges_of().
std::vector<std::vector<std::uint32_t>> neighbours_of(
    std::size_t node_count, std::span<const std::array<std::uint32_t, 2>> edges);

/// Pairs of nodes joined by a path of two edges but by no edge, each once, sorted. Of a node with n
/// neighbours there are about n²/2: where there are more than `most`, not all are found.
/// @param neighbours  ascending
std::vector<std::array<std::uint32_t, 2>> second_neighbours_of(
    std::span<const std::vector<std::uint32_t>> neighbours, std::size_t most);

/// Sets joined together, for components and fans.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count);
  std::uint32_t root(std::uint32_t item);
  void join(std::uint32_t a, std::uint32_t b);

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace palpate::geometry
