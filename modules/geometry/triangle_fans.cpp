#include "modules/geometry/triangle_fans.h"

#include <algorithm>
#include <set>

#include "modules/core/error.h"

namespace palpate::geometry {

std::vector<std::vector<std::uint32_t>> ordered_one_rings(const std::vector<Triangle>& triangles,
                                                          std::size_t node_count) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;  // opposite a node: from, to
  std::vector<std::vector<Edge>> fans(node_count);
  for (const auto& [i, j, k] : triangles) {
    fans[i].emplace_back(j, k);
    fans[j].emplace_back(k, i);
    fans[k].emplace_back(i, j);
  }
  std::vector<std::vector<std::uint32_t>> rings(node_count);
  for (std::size_t node = 0; node < node_count; ++node) {
    auto& fan = fans[node];
    PALPATE_DEMAND(!fan.empty());
    std::sort(fan.begin(), fan.end());
    std::uint32_t next = fan.front().first;
    do {
      rings[node].push_back(next);
      const auto edge = std::lower_bound(fan.begin(), fan.end(), Edge{next, 0});
      PALPATE_DEMAND(edge != fan.end() && edge->first == next);
      next = edge->second;
    } while (next != rings[node].front() && rings[node].size() <= fan.size());
    PALPATE_DEMAND(rings[node].size() == fan.size());
  }
  return rings;
}

std::vector<Fan> fans_of(const std::vector<std::vector<std::uint32_t>>& rings) {
  // left[node][k]: the triangle from the k-th neighbour to the next is still in no fan.
  std::vector<std::vector<char>> left;
  std::set<std::pair<std::ptrdiff_t, std::uint32_t>> order;  // −triangles left, node
  for (std::uint32_t node = 0; node < rings.size(); ++node) {
    left.emplace_back(rings[node].size(), 1);
    order.emplace(-static_cast<std::ptrdiff_t>(rings[node].size()), node);
  }
  const auto take = [&](std::uint32_t node, std::uint32_t from) {
    const auto count = std::count(left[node].begin(), left[node].end(), 1);
    order.erase({-count, node});
    const auto& ring = rings[node];
    left[node][static_cast<std::size_t>(std::find(ring.begin(), ring.end(), from) - ring.begin())] =
        0;
    if (count > 1) order.emplace(1 - count, node);
  };
  std::vector<Fan> fans;
  while (!order.empty()) {
    const std::uint32_t center = order.begin()->second;
    const auto& ring = rings[center];
    // The fan starts after a triangle that another fan has, or anywhere if there is none.
    const auto start = static_cast<std::size_t>(
        std::find(left[center].begin(), left[center].end(), 0) - left[center].begin());
    bool open = false;
    for (std::size_t step = 0; step < ring.size(); ++step) {
      const std::size_t k = (start + step) % ring.size();
      const std::uint32_t from = ring[k], to = ring[(k + 1) % ring.size()];
      const bool here = left[center][k] != 0;
      if (here && !open) fans.push_back({center, {from}});
      open = here;
      if (!here) continue;
      fans.back().nodes.push_back(to);
      take(center, from);
      take(from, to);
      take(to, center);
    }
  }
  return fans;
}

}  // namespace palpate::geometry
