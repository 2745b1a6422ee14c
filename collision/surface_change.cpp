#include "collision/surface_change.h"

#include <algorithm>

namespace palpate::collision {

std::uint32_t SurfaceChange::edge(std::uint32_t of_before) const {
  constexpr double kNextToMiddle = 0.51;
  const SurfaceEdge& edge = before.edges()[of_before];
  const geometry::Triangle& corners = before.triangles()[edge.triangles[0]];
  Vec3 weights = Vec3::Zero();
  weights[std::ranges::find(corners, edge.nodes[0]) - corners.begin()] = kNextToMiddle;
  weights[std::ranges::find(corners, edge.nodes[1]) - corners.begin()] = 1 - kNextToMiddle;
  const geometry::PlaceOnSurface place = transfer.place({edge.triangles[0], weights});
  Eigen::Index off = 0;
  place.weights.minCoeff(&off);
  const geometry::Triangle& there = after.triangles()[place.triangle];
  for (const std::uint32_t e : after.edges_of_triangle(place.triangle)) {
    const auto& nodes = after.edges()[e].nodes;
    if (std::ranges::find(nodes, there[static_cast<std::size_t>(off)]) == nodes.end()) return e;
  }
  return after.edges_of_triangle(place.triangle)[0];
}

std::vector<Vec3> carried_positions(const OrganSurface& from, const OrganSurface& to,
                                    const geometry::SurfaceTransfer& back) {
  std::vector<Vec3> positions(to.node_count(), Vec3::Zero());
  for (std::uint32_t t = 0; t < to.triangles().size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t node = to.triangles()[t][k];
      if (to.triangles_of_node(node).front() != t) continue;
      if (back.node(node) != geometry::kNoPlace) {
        positions[node] = from.positions()[back.node(node)];
        continue;
      }
      const auto place = back.place({t, Vec3::Unit(static_cast<Eigen::Index>(k))});
      const auto corners = from.corners(place.triangle);
      for (std::size_t j = 0; j < 3; ++j) {
        positions[node] += place.weights[static_cast<Eigen::Index>(j)] * corners[j];
      }
    }
  }
  return positions;
}

}  // namespace palpate::collision
