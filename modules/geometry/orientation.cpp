#include "modules/geometry/orientation.h"

#include <algorithm>

#include "modules/geometry/edge_uses.h"

namespace palpate::geometry {
namespace {

struct Link {
  std::uint32_t neighbour = 0;
  bool agrees = true;
};

struct Neighbours {
  std::vector<std::array<Link, 3>> links;  // per triangle
  std::vector<std::uint8_t> counts;        // of the links in use
};

Neighbours links_of(const TriangleSurface& surface) {
  const std::size_t count = surface.triangles.size();
  Neighbours result{std::vector<std::array<Link, 3>>(count), std::vector<std::uint8_t>(count, 0)};
  const std::vector<EdgeUse> uses = edge_uses_of(surface.triangles);
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() != 2 || edge[0].triangle == edge[1].triangle) return;
    const bool agrees = edge[0].forward != edge[1].forward;
    for (int i = 0; i < 2; ++i) {
      const std::uint32_t t = edge[i].triangle;
      result.links[t][result.counts[t]++] = {edge[1 - i].triangle, agrees};
    }
  });
  return result;
}

void turn(Triangle& triangle) { std::swap(triangle[1], triangle[2]); }

/// Visits the shell of `seed`; `turned` tells for each of its triangles if it has to turn to
/// agree with the seed. @return the shell's triangles
std::vector<std::uint32_t> walk_shell(const Neighbours& neighbours, std::uint32_t seed,
                                      std::vector<bool>& visited, std::vector<bool>& turned) {
  std::vector<std::uint32_t> shell{seed};
  visited[seed] = true;
  for (std::size_t next = 0; next < shell.size(); ++next) {
    const std::uint32_t t = shell[next];
    for (int i = 0; i < neighbours.counts[t]; ++i) {
      const Link& link = neighbours.links[t][i];
      if (visited[link.neighbour]) continue;
      visited[link.neighbour] = true;
      turned[link.neighbour] = turned[t] != !link.agrees;
      shell.push_back(link.neighbour);
    }
  }
  return shell;
}

bool is_closed(const Neighbours& neighbours, const std::vector<std::uint32_t>& shell) {
  return std::all_of(shell.begin(), shell.end(),
                     [&](std::uint32_t t) { return neighbours.counts[t] == 3; });
}

double shell_volume(const TriangleSurface& surface, const std::vector<std::uint32_t>& shell) {
  std::vector<Triangle> triangles;
  for (const std::uint32_t t : shell) triangles.push_back(surface.triangles[t]);
  return enclosed_volume(surface.nodes, triangles);
}

}  // namespace

OrientationLog orient_outward(TriangleSurface& surface) {
  OrientationLog log;
  const Neighbours neighbours = links_of(surface);
  std::vector<bool> visited(surface.triangles.size(), false),
      turned(surface.triangles.size(), false);
  for (std::uint32_t seed = 0; seed < surface.triangles.size(); ++seed) {
    if (visited[seed]) continue;
    const std::vector<std::uint32_t> shell = walk_shell(neighbours, seed, visited, turned);
    std::size_t to_turn = 0;
    for (const std::uint32_t t : shell) to_turn += turned[t];
    const bool majority_turns = 2 * to_turn > shell.size();
    for (const std::uint32_t t : shell) {
      if (turned[t] == majority_turns) continue;
      turn(surface.triangles[t]);
      ++log.flipped_triangles;
    }
    if (is_closed(neighbours, shell) && shell_volume(surface, shell) < 0) {
      for (const std::uint32_t t : shell) turn(surface.triangles[t]);
      ++log.flipped_shells;
    }
  }
  return log;
}

}  // namespace palpate::geometry
