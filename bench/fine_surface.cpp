#include "bench/fine_surface.h"

#include <algorithm>

#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/node_order.h"

namespace palpate::bench {
namespace {

constexpr std::size_t kMostResampled = 20'000;  // nodes

/// Every triangle into four.
geometry::TriangleSurface halve_edges(const geometry::TriangleSurface& surface) {
  geometry::TriangleSurface fine{surface.nodes, {}};
  const auto edges = geometry::edges_of(surface.triangles);
  for (const auto& [a, b] : edges) {
    fine.nodes.push_back((surface.nodes[a] + surface.nodes[b]) / 2);
  }
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const std::array<std::uint32_t, 2> edge{std::min(a, b), std::max(a, b)};
    const auto found = std::lower_bound(edges.begin(), edges.end(), edge);
    return static_cast<std::uint32_t>(surface.nodes.size() +
                                      static_cast<std::size_t>(found - edges.begin()));
  };
  for (const auto& [a, b, c] : surface.triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const geometry::Triangle& t :
         {geometry::Triangle{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}}) {
      fine.triangles.push_back(t);
    }
  }
  return fine;
}

}  // namespace

geometry::TriangleSurface fine_surface(const geometry::TriangleSurface& organ, std::size_t nodes) {
  int halvings = 0;
  for (; nodes > kMostResampled; nodes /= 4) ++halvings;
  auto surface = geometry::resample_surface(organ, nodes);
  for (int k = 0; k < halvings; ++k) surface = halve_edges(surface);
  if (halvings > 0) geometry::order_nodes_by_neighbourhood(surface);
  return surface;
}

}  // namespace palpate::bench
