#include "modules/scene/spring_count.h"

#include <algorithm>
#include <sstream>

#include "modules/core/error.h"
#include "modules/core/organ_limits.h"
#include "modules/geometry/edge_uses.h"

namespace palpate::scene {
namespace {

using NeighbourLists = std::vector<std::vector<std::uint32_t>>;

/// Each pair once for every node between: at least as many as there are pairs.
std::size_t paths_of_two_edges(const NeighbourLists& neighbours) {
  std::size_t paths = 0;
  for (const auto& around : neighbours) paths += around.size() * (around.size() - 1) / 2;
  return paths;
}

}  // namespace

void check_spring_count(const geometry::TriangleSurface& surface, const Springs& springs) {
  if (surface.nodes.size() > kMaxNodes || surface.triangles.size() > kMaxTriangles) return;
  if (!(springs.bending_ratio > 0)) return;
  const auto edges = geometry::edges_of(surface.triangles);
  const bool has_inner = springs.inner_ratio > 0 && springs.virtual_nodes > 0;
  const std::size_t most = kMaxSprings - edges.size() - (has_inner ? surface.nodes.size() : 0);
  const auto neighbours = geometry::neighbours_of(surface.nodes.size(), edges);
  if (paths_of_two_edges(neighbours) <= most) return;
  if (geometry::second_neighbours_of(neighbours, most).size() <= most) return;
  const auto middle = std::ranges::max_element(neighbours, {}, &NeighbourLists::value_type::size);
  const Vec3& place = surface.nodes[static_cast<std::size_t>(middle - neighbours.begin())];
  std::ostringstream text;
  text << "its surface asks for more than " << kMaxSprings
       << " springs, the most that a message holds: " << middle->size()
       << " triangles meet at its node at (" << place.x() << ", " << place.y() << ", " << place.z()
       << ") m, and bending springs join each of their nodes to all others; key 'mesh.nodes' "
          "resamples the surface, key 'springs.bending_ratio' 0 leaves bending springs out";
  throw InputError(text.str());
}

}  // namespace palpate::scene
