#include "modules/geometry/weld.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "modules/geometry/edge_uses.h"

namespace palpate::geometry {
namespace {

constexpr std::uint32_t kNotKept = std::numeric_limits<std::uint32_t>::max();

/// Keeps the nodes that stand for themselves in `stands_for` and renumbers the triangles.
std::size_t keep_representatives(TriangleSurface& surface,
                                 const std::vector<std::uint32_t>& stands_for) {
  std::vector<std::uint32_t> new_index(surface.nodes.size(), kNotKept);
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < stands_for.size(); ++i) {
    if (stands_for[i] != i) continue;
    surface.nodes[kept] = surface.nodes[i];
    new_index[i] = kept++;
  }
  const std::size_t removed = surface.nodes.size() - kept;
  surface.nodes.resize(kept);
  for (Triangle& triangle : surface.triangles) {
    for (std::uint32_t& node : triangle) node = new_index[stands_for[node]];
  }
  return removed;
}

}  // namespace

std::size_t weld_nodes(TriangleSurface& surface) {
  const auto& nodes = surface.nodes;
  std::vector<std::uint32_t> order(nodes.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    for (int axis = 0; axis < 3; ++axis) {
      if (nodes[a][axis] != nodes[b][axis]) return nodes[a][axis] < nodes[b][axis];
    }
    return a < b;
  };
  std::sort(order.begin(), order.end(), before);
  std::vector<std::uint32_t> stands_for(nodes.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && nodes[order[i]] == nodes[order[i - 1]];
    stands_for[order[i]] = same ? stands_for[order[i - 1]] : order[i];
  }
  return keep_representatives(surface, stands_for);
}

std::size_t weld_cracks(TriangleSurface& surface, double tolerance) {
  const auto& nodes = surface.nodes;
  std::vector<std::uint32_t> border;
  const std::vector<EdgeUse> uses = edge_uses_of(surface.triangles);
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() == 1) border.insert(border.end(), {edge[0].a, edge[0].b});
  });
  std::sort(border.begin(), border.end(), [&](std::uint32_t a, std::uint32_t b) {
    return nodes[a].x() != nodes[b].x() ? nodes[a].x() < nodes[b].x() : a < b;
  });
  border.erase(std::unique(border.begin(), border.end()), border.end());
  DisjointSets places(nodes.size());
  for (std::size_t i = 0; i < border.size(); ++i) {  // only a thin slab in x can be near
    for (std::size_t j = i + 1; j < border.size(); ++j) {
      const Vec3 difference = nodes[border[j]] - nodes[border[i]];
      if (difference.x() > tolerance) break;
      if (difference.norm() <= tolerance) places.join(border[i], border[j]);
    }
  }
  std::vector<std::uint32_t> stands_for(nodes.size());
  for (std::uint32_t i = 0; i < nodes.size(); ++i) stands_for[i] = places.root(i);
  return keep_representatives(surface, stands_for);
}

std::size_t drop_unused_nodes(TriangleSurface& surface) {
  std::vector<std::uint32_t> stands_for(surface.nodes.size(), kNotKept);
  for (const Triangle& triangle : surface.triangles) {
    for (const std::uint32_t node : triangle) stands_for[node] = node;
  }
  return keep_representatives(surface, stands_for);
}

}  // namespace palpate::geometry
