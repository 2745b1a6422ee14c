// The resampling part of mesh_prepare.h: isotropic remeshing towards the edge length that gives
// the wanted count, then single splits or collapses until the count is exact.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "modules/core/error.h"
#include "modules/core/organ_limits.h"
#include "modules/core/stop_signal.h"
#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/node_order.h"
#include "modules/geometry/remesh.h"

namespace palpate::geometry {
namespace {

constexpr int kRounds = 8;            // of splitting, collapsing, flipping and relaxing
constexpr int kMostSweeps = 40;       // inside a round; a sweep changes up to a third of the nodes
constexpr int kPolishingRounds = 12;  // of flipping and relaxing, the count being exact
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Edge length L at which N nodes of equilateral triangles cover the area:
/// (2N − 4) triangles · (√3/4) L² = A.
double edge_length_for(double area, std::size_t node_count) {
  const double triangles = std::max(4.0, 2.0 * static_cast<double>(node_count) - 4);
  return std::sqrt(4 * area / (std::sqrt(3.0) * triangles));
}

/// @param pulse  called between pieces of the work
void remesh_once(RemeshMesh& mesh, const AabbTree& target, double length, const Pulse& pulse) {
  const double longest = 4.0 / 3 * length, shortest = 4.0 / 5 * length;
  const std::size_t no_limit = std::numeric_limits<std::size_t>::max();
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    pulse();
    if (split_long_edges(mesh, longest, no_limit) == 0) break;
  }
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    pulse();
    if (collapse_short_edges(mesh, target, shortest, longest, 4, pulse) == 0) break;
  }
  pulse();
  equalize_valences(mesh, pulse);
  relax_on(mesh, target, pulse);
}

void reach_count(RemeshMesh& mesh, const AabbTree& target, std::size_t node_count,
                 const Pulse& pulse) {
  for (int sweep = 0; sweep < kMostSweeps && mesh.n_vertices() > node_count; ++sweep) {
    pulse();
    if (collapse_short_edges(mesh, target, kInfinity, kInfinity, node_count, pulse) == 0) break;
    equalize_valences(mesh, pulse);
  }
  for (int sweep = 0; sweep < kMostSweeps && mesh.n_vertices() < node_count; ++sweep) {
    pulse();
    if (split_long_edges(mesh, 0, node_count) == 0) break;
    equalize_valences(mesh, pulse);
  }
}

void scale_to_volume(TriangleSurface& surface, double volume) {
  const double now = enclosed_volume(surface.nodes, surface.triangles);
  if (!(now > 0)) return;
  const Vec3 centroid = solid_centroid(surface);
  const double scale = std::cbrt(volume / now);
  for (Vec3& node : surface.nodes) node = centroid + scale * (node - centroid);
}

[[noreturn]] void refuse(std::size_t node_count, const std::string& why) {
  throw InputError("cannot resample to " + std::to_string(node_count) + " nodes: " + why);
}

void check_request(const TriangleSurface& surface, std::size_t node_count) {
  if (node_count < 4 || node_count > kMaxNodes) {
    refuse(node_count, "allowed: 4 to " + std::to_string(kMaxNodes));
  }
  const MeshReport report = check_surface(surface);
  if (report.is_closed_manifold() && report.volume > 0) return;
  const auto problems = describe_problems(report, surface);
  refuse(node_count, problems.empty() ? "the surface encloses no volume" : problems.front());
}

}  // namespace

TriangleSurface resample_surface(const TriangleSurface& surface, std::size_t node_count,
                                 const std::function<void(double)>& progress) {
  check_request(surface, node_count);
  if (surface.nodes.size() == node_count) return surface;
  const double volume = enclosed_volume(surface.nodes, surface.triangles);
  const AabbTree target(surface);
  RemeshMesh mesh = to_remesh_mesh(surface);
  double length = edge_length_for(surface_area(surface.nodes, surface.triangles), node_count);
  int done = 0;  // a round of remeshing takes about four times one of polishing
  const auto pulse = [&] {
    if (stop_requested()) throw Interrupted("stopped while a surface was resampled");
    if (progress) progress(double(done) / (4 * kRounds + kPolishingRounds));
  };
  for (int round = 0; round < kRounds; ++round) {
    remesh_once(mesh, target, length, pulse);
    done += 4;
    const double ratio = static_cast<double>(mesh.n_vertices()) / static_cast<double>(node_count);
    length *= std::clamp(std::sqrt(ratio), 0.8, 1.25);
  }
  reach_count(mesh, target, node_count, pulse);
  for (int round = 0; round < kPolishingRounds; ++round) {
    equalize_valences(mesh, pulse);
    relax_on(mesh, target, pulse);
    ++done;
    pulse();
  }
  TriangleSurface result = to_surface(mesh);
  scale_to_volume(result, volume);
  order_nodes_by_neighbourhood(result);
  const MeshReport report = check_surface(result);
  const auto problems = describe_problems(report, result);
  if (!problems.empty()) {
    refuse(node_count, problems.front() + " (in the result); use more nodes");
  }
  return result;
}

}  // namespace palpate::geometry
