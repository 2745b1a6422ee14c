#include "modules/geometry/node_order.h"

#include <algorithm>
#include <limits>

#include "modules/geometry/edge_uses.h"

namespace palpate::geometry {
namespace {

constexpr std::uint32_t kUnset = std::numeric_limits<std::uint32_t>::max();

/// The old indices in their new order.
std::vector<std::uint32_t> breadth_first(const TriangleSurface& surface) {
  const auto neighbours = neighbours_of(surface.nodes.size(), edges_of(surface.triangles));
  std::vector<std::uint32_t> order;
  std::vector<bool> seen(surface.nodes.size(), false);
  std::size_t next = 0;
  for (std::uint32_t seed = 0; seed < surface.nodes.size(); ++seed) {
    if (seen[seed]) continue;
    seen[seed] = true;
    order.push_back(seed);
    for (; next < order.size(); ++next) {
      for (const std::uint32_t neighbour : neighbours[order[next]]) {
        if (seen[neighbour]) continue;
        seen[neighbour] = true;
        order.push_back(neighbour);
      }
    }
  }
  return order;
}

}  // namespace

void order_nodes_by_neighbourhood(TriangleSurface& surface) {
  const std::vector<std::uint32_t> order = breadth_first(surface);
  std::vector<std::uint32_t> new_index(order.size(), kUnset);
  std::vector<Vec3> nodes;
  nodes.reserve(order.size());
  for (const std::uint32_t old_index : order) {
    new_index[old_index] = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back(surface.nodes[old_index]);
  }
  surface.nodes = std::move(nodes);
  for (Triangle& triangle : surface.triangles) {
    for (std::uint32_t& node : triangle) node = new_index[node];
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()),
                triangle.end());
  }
  std::sort(surface.triangles.begin(), surface.triangles.end());
}

}  // namespace palpate::geometry
