#include "modules/geometry/mesh_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "modules/geometry/edge_uses.h"
#include "modules/geometry/self_intersection.h"

namespace palpate::geometry {
namespace {

double extent_of(const MeshReport& report) {
  return (report.max_corner - report.min_corner).norm();
}

void measure_whole(const TriangleSurface& surface, MeshReport& report) {
  report.node_count = surface.nodes.size();
  report.triangle_count = surface.triangles.size();
  report.area = surface_area(surface.nodes, surface.triangles);
  report.volume = enclosed_volume(surface.nodes, surface.triangles);
  if (!surface.nodes.empty()) report.min_corner = report.max_corner = surface.nodes[0];
  for (const Vec3& node : surface.nodes) {
    report.min_corner = report.min_corner.cwiseMin(node);
    report.max_corner = report.max_corner.cwiseMax(node);
  }
  const auto [x, y, z] = three_axis_volumes(surface.nodes, surface.triangles);
  const double scale = report.area * extent_of(report);
  if (scale > 0) report.leak = (std::max({x, y, z}) - std::min({x, y, z})) / scale;
}

void check_triangles(const TriangleSurface& surface, MeshReport& report) {
  const double extent = extent_of(report);
  report.shortest_edge = surface.triangles.empty() ? 0 : std::numeric_limits<double>::infinity();
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    const Triangle& triangle = surface.triangles[t];
    double longest = 0;
    for (int i = 0; i < 3; ++i) {
      const double length =
          (surface.nodes[triangle[i]] - surface.nodes[triangle[(i + 1) % 3]]).norm();
      longest = std::max(longest, length);
      report.shortest_edge = std::min(report.shortest_edge, length);
    }
    report.longest_edge = std::max(report.longest_edge, longest);
    const double area = area_vector(surface.nodes, triangle).norm();
    if (area <= kDegenerateArea * extent * extent) {
      report.degenerate_triangles.push_back(t);
    } else {
      report.worst_aspect =
          std::max(report.worst_aspect, std::sqrt(3.0) / 4 * longest * longest / area);
    }
  }
}

void check_duplicates(const TriangleSurface& surface, MeshReport& report) {
  std::map<Triangle, std::uint32_t> seen;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    Triangle key = surface.triangles[t];
    std::sort(key.begin(), key.end());
    if (!seen.try_emplace(key, t).second) report.duplicate_triangles.push_back(t);
  }
}

std::size_t check_edges(std::span<const EdgeUse> uses, MeshReport& report) {
  std::size_t edge_count = 0;
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    ++edge_count;
    const std::array<std::uint32_t, 2> nodes{edge[0].a, edge[0].b};
    if (edge.size() == 1) report.border_edges.push_back(nodes);
    if (edge.size() > 2) report.non_manifold_edges.push_back(nodes);
    if (edge.size() == 2 && edge[0].forward == edge[1].forward) {
      report.inconsistent_edges.push_back(nodes);
    }
  });
  return edge_count;
}

/// A node is manifold if its triangles, joined over shared edges, are one fan.
void check_fans(const TriangleSurface& surface, std::span<const EdgeUse> uses, MeshReport& report) {
  // One item per corner of a triangle; corners at the same node join over the shared edge.
  DisjointSets corners(3 * surface.triangles.size());
  const auto corner_of = [&](std::uint32_t triangle, std::uint32_t node) {
    const Triangle& t = surface.triangles[triangle];
    const auto place = std::find(t.begin(), t.end(), node) - t.begin();
    return 3 * triangle + static_cast<std::uint32_t>(place);
  };
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    for (const EdgeUse& use : edge.subspan(1)) {
      corners.join(corner_of(edge[0].triangle, use.a), corner_of(use.triangle, use.a));
      corners.join(corner_of(edge[0].triangle, use.b), corner_of(use.triangle, use.b));
    }
  });
  std::vector<std::uint32_t> fans(surface.nodes.size(), 0);
  std::vector<bool> used(surface.nodes.size(), false);
  for (std::uint32_t corner = 0; corner < 3 * surface.triangles.size(); ++corner) {
    const std::uint32_t node = surface.triangles[corner / 3][corner % 3];
    used[node] = true;
    if (corners.root(corner) == corner) ++fans[node];
  }
  for (std::uint32_t node = 0; node < surface.nodes.size(); ++node) {
    if (!used[node]) report.unused_nodes.push_back(node);
    if (fans[node] > 1) report.non_manifold_nodes.push_back(node);
  }
}

std::size_t count_components(const TriangleSurface& surface) {
  DisjointSets sets(surface.nodes.size());
  std::vector<bool> used(surface.nodes.size(), false);
  for (const auto& [a, b, c] : surface.triangles) {
    sets.join(a, b);
    sets.join(a, c);
    used[a] = used[b] = used[c] = true;
  }
  std::size_t count = 0;
  for (std::uint32_t node = 0; node < surface.nodes.size(); ++node) {
    if (used[node] && sets.root(node) == node) ++count;
  }
  return count;
}

}  // namespace

bool MeshReport::is_closed_manifold() const {
  return triangle_count > 0 && border_edges.empty() && non_manifold_edges.empty() &&
         non_manifold_nodes.empty() && unused_nodes.empty() && degenerate_triangles.empty() &&
         duplicate_triangles.empty() && inconsistent_edges.empty();
}

bool MeshReport::holds_volume() const {
  return is_closed_manifold() && component_count == 1 && !inside_out && volume > 0 &&
         self_intersections.empty();
}

MeshReport check_surface(const TriangleSurface& surface) {
  MeshReport report;
  measure_whole(surface, report);
  check_triangles(surface, report);
  check_duplicates(surface, report);
  const std::vector<EdgeUse> uses = edge_uses_of(surface.triangles);
  const std::size_t edge_count = check_edges(uses, report);
  check_fans(surface, uses, report);
  report.component_count = count_components(surface);
  const bool closed = report.border_edges.empty() && report.non_manifold_edges.empty();
  if (closed && report.component_count == 1) {  // Euler: V − E + F = 2 − 2·genus
    const auto used_nodes = static_cast<long>(report.node_count - report.unused_nodes.size());
    const long euler =
        used_nodes - static_cast<long>(edge_count) + static_cast<long>(report.triangle_count);
    report.genus = static_cast<int>((2 - euler) / 2);
  }
  report.inside_out = closed && report.inconsistent_edges.empty() && report.volume < 0;
  report.self_intersections = find_self_intersections(surface);
  return report;
}

}  // namespace palpate::geometry
