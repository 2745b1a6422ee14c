#include "modules/geometry/shells.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "modules/geometry/edge_uses.h"

namespace palpate::geometry {
namespace {

/// The triangles of one part, with nodes of its own.
class Part {
 public:
  void add(const Triangle& triangle, const std::vector<Vec3>& nodes) {
    Triangle own{};
    std::transform(triangle.begin(), triangle.end(), own.begin(), [&](std::uint32_t node) {
      const auto [place, is_new] =
          numbers_.try_emplace(node, static_cast<std::uint32_t>(surface.nodes.size()));
      if (is_new) surface.nodes.push_back(nodes[node]);
      return place->second;
    });
    surface.triangles.push_back(own);
  }

  TriangleSurface surface;

 private:
  std::map<std::uint32_t, std::uint32_t> numbers_;
};

}  // namespace

std::vector<TriangleSurface> shells_of(const TriangleSurface& surface) {
  DisjointSets sets(surface.nodes.size());
  for (const auto& [a, b, c] : surface.triangles) {
    sets.join(a, b);
    sets.join(a, c);
  }
  std::map<std::uint32_t, Part> parts;
  for (const Triangle& triangle : surface.triangles) {
    parts[sets.root(triangle[0])].add(triangle, surface.nodes);
  }
  if (parts.size() <= 1) return {surface};
  std::vector<TriangleSurface> shells;
  for (auto& [root, part] : parts) shells.push_back(std::move(part.surface));
  std::stable_sort(shells.begin(), shells.end(), [](const auto& a, const auto& b) {
    return std::abs(enclosed_volume(a.nodes, a.triangles)) >
           std::abs(enclosed_volume(b.nodes, b.triangles));
  });
  return shells;
}

std::size_t fill_holes(TriangleSurface& surface) {
  constexpr std::uint32_t kTwice = 0xffffffff;
  // Along a hole's border, against the triangles that have it: from a node to the next.
  std::map<std::uint32_t, std::uint32_t> next;
  const auto uses = edge_uses_of(surface.triangles);
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() != 1) return;
    const auto from = edge[0].forward ? edge[0].b : edge[0].a;
    const auto to = edge[0].forward ? edge[0].a : edge[0].b;
    const auto [place, is_new] = next.try_emplace(from, to);
    if (!is_new) place->second = kTwice;
  });
  std::size_t filled = 0;
  while (!next.empty()) {
    std::vector<std::uint32_t> border{next.begin()->first};
    bool closed = false;
    for (auto step = next.find(border[0]); step != next.end();) {
      const std::uint32_t to = step->second;
      next.erase(step);
      closed = to == border[0];
      if (closed || to == kTwice) break;
      border.push_back(to);
      step = next.find(to);
    }
    if (!closed || border.size() < 3) continue;
    Vec3 middle = Vec3::Zero();
    for (const std::uint32_t node : border) middle += surface.nodes[node];
    const auto centre = static_cast<std::uint32_t>(surface.nodes.size());
    surface.nodes.push_back(middle / double(border.size()));
    for (std::size_t i = 0; i < border.size(); ++i) {
      surface.triangles.push_back({border[i], border[(i + 1) % border.size()], centre});
    }
    ++filled;
  }
  return filled;
}

}  // namespace palpate::geometry
