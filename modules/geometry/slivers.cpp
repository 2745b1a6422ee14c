#include "modules/geometry/slivers.h"

#include <algorithm>

#include "modules/geometry/bounding_box.h"
#include "modules/geometry/edge_uses.h"
#include "modules/geometry/mesh_check.h"

namespace palpate::geometry {
namespace {

constexpr int kMostPasses = 8;  // a flipped sliver may leave another one next to it

double squared_extent(std::span<const Vec3> nodes) {
  return nodes.empty() ? 0 : bounding_box(nodes).diagonal().squaredNorm();
}

/// Index of the corner opposite to the longest side.
int middle_corner(const TriangleSurface& surface, const Triangle& t) {
  int middle = 0;
  double longest = -1;
  for (int i = 0; i < 3; ++i) {
    const double side = (surface.nodes[t[(i + 1) % 3]] - surface.nodes[t[(i + 2) % 3]]).norm();
    if (side > longest) {
      longest = side;
      middle = i;
    }
  }
  return middle;
}

/// The uses of the edge {a, b} in the sorted list.
std::span<const EdgeUse> uses_of_edge(std::span<const EdgeUse> uses, std::uint32_t a,
                                      std::uint32_t b) {
  const std::array<std::uint32_t, 2> key{std::min(a, b), std::max(a, b)};
  const auto begin =
      std::lower_bound(uses.begin(), uses.end(), key, [](const EdgeUse& use, const auto& wanted) {
        return std::array{use.a, use.b} < wanted;
      });
  auto end = begin;
  while (end != uses.end() && end->a == key[0] && end->b == key[1]) ++end;
  return {begin, end};
}

bool flip(TriangleSurface& surface, std::span<const EdgeUse> uses, std::uint32_t sliver,
          std::vector<bool>& changed) {
  const Triangle t = surface.triangles[sliver];
  const int corner = middle_corner(surface, t);
  const std::uint32_t middle = t[corner], a = t[(corner + 1) % 3], b = t[(corner + 2) % 3];
  const auto shared = uses_of_edge(uses, a, b);
  if (shared.size() != 2) return false;
  const std::uint32_t other = shared[shared[0].triangle == sliver].triangle;
  if (other == sliver || changed[other]) return false;
  const Triangle neighbour = surface.triangles[other];
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t from = neighbour[i], to = neighbour[(i + 1) % 3],
                        apex = neighbour[(i + 2) % 3];
    if (std::minmax(from, to) != std::minmax(a, b)) continue;
    if (apex == middle || !uses_of_edge(uses, middle, apex).empty()) return false;
    surface.triangles[sliver] = {from, middle, apex};
    surface.triangles[other] = {middle, to, apex};
    changed[sliver] = changed[other] = true;
    return true;
  }
  return false;
}

}  // namespace

std::size_t flip_slivers(TriangleSurface& surface) {
  const double threshold = kDegenerateArea * squared_extent(surface.nodes);
  std::size_t flipped = 0;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    std::vector<std::uint32_t> slivers;
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      if (area_vector(surface.nodes, surface.triangles[t]).norm() <= threshold) {
        slivers.push_back(t);
      }
    }
    if (slivers.empty()) break;
    const std::vector<EdgeUse> uses = edge_uses_of(surface.triangles);
    std::vector<bool> changed(surface.triangles.size(), false);
    std::size_t flipped_now = 0;
    for (const std::uint32_t t : slivers) {
      if (!changed[t]) flipped_now += flip(surface, uses, t, changed);
    }
    if (flipped_now == 0) break;
    flipped += flipped_now;
  }
  return flipped;
}

}  // namespace palpate::geometry
