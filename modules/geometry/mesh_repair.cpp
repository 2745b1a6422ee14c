// The repairing half of mesh_prepare.h.
#include <algorithm>
#include <map>

#include "modules/geometry/bounding_box.h"
#include "modules/geometry/edge_uses.h"
#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/orientation.h"
#include "modules/geometry/slivers.h"
#include "modules/geometry/weld.h"

namespace palpate::geometry {
namespace {

// Part of the extent: a few roundings of single precision, far below any triangle worth having.
constexpr double kCrackWidth = 1e-6;

double extent_of(const TriangleSurface& surface) {
  return surface.nodes.empty() ? 0 : bounding_box(surface.nodes).diagonal().norm();
}

bool has_repeated_node(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

std::size_t count_bad_edges(std::span<const Triangle> triangles) {
  std::size_t count = 0;
  const std::vector<EdgeUse> uses = edge_uses_of(triangles);
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) { count += edge.size() != 2; });
  return count;
}

/// Triangles on the same three nodes are either copies (keep one) or an inner wall between two
/// solids that were put together (keep none): whichever leaves fewer open or overfull edges.
std::size_t drop_duplicates(TriangleSurface& surface) {
  std::map<Triangle, std::uint32_t> uses;
  const auto key_of = [](Triangle t) {
    std::sort(t.begin(), t.end());
    return t;
  };
  for (const Triangle& t : surface.triangles) ++uses[key_of(t)];
  if (uses.size() == surface.triangles.size()) return 0;
  std::vector<Triangle> one_of_each, none_of_repeated;
  for (const Triangle& t : surface.triangles) {
    std::uint32_t& left = uses[key_of(t)];
    if (left == 0) continue;  // a further copy
    one_of_each.push_back(t);
    if (left == 1) none_of_repeated.push_back(t);
    left = 0;
  }
  const std::size_t before = surface.triangles.size();
  const bool walls = count_bad_edges(none_of_repeated) < count_bad_edges(one_of_each);
  surface.triangles = std::move(walls ? none_of_repeated : one_of_each);
  return before - surface.triangles.size();
}

void log_count(RepairLog& log, std::size_t count, const std::string& what) {
  if (count > 0) log.actions.push_back(what + ": " + std::to_string(count));
}

}  // namespace

RepairLog repair_surface(TriangleSurface& surface) {
  RepairLog log;
  log_count(log, weld_nodes(surface), "nodes at the same place joined");
  log_count(log, weld_cracks(surface, kCrackWidth * extent_of(surface)),
            "nodes across cracks thinner than 1e-6 of the size joined");
  log_count(log, std::erase_if(surface.triangles, has_repeated_node),
            "triangles with two corners at one place dropped");
  log_count(log, drop_duplicates(surface), "triangles lying on each other dropped");
  log_count(log, flip_slivers(surface), "triangles without area flipped into their neighbours");
  log_count(log, drop_unused_nodes(surface), "nodes of no triangle dropped");
  const OrientationLog orientation = orient_outward(surface);
  log_count(log, orientation.flipped_triangles, "triangles turned to agree with their neighbours");
  log_count(log, orientation.flipped_shells, "shells that were inside out turned outward");
  return log;
}

}  // namespace palpate::geometry
