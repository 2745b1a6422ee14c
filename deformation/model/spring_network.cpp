#include "deformation/model/spring_network.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/core/error.h"
#include "modules/geometry/edge_uses.h"
#include "modules/scene/spring_count.h"

namespace palpate::deformation {
namespace {

using NodePair = std::array<std::uint32_t, 2>;

std::size_t nearest(const std::vector<Vec3>& points, const Vec3& p) {
  std::size_t best = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if ((points[i] - p).squaredNorm() < (points[best] - p).squaredNorm()) best = i;
  }
  return best;
}

/// E t of the springs [N/m].
double membrane_stiffness(const scene::Tissue& tissue) {
  return kMembraneFactor * tissue.youngs_modulus * tissue.wall_thickness;
}

/// Each edge: (√3/4) E t per adjacent triangle, that is twice on a closed surface.
void add_membrane_springs(const geometry::TriangleSurface& surface, const scene::Tissue& tissue,
                          double bending_ratio, SpringNetwork& network) {
  const auto edges = geometry::edges_of(surface.triangles);
  const double structural =
      2 * (std::sqrt(3.0) / 4) * membrane_stiffness(tissue) / (1 + 7 * bending_ratio);
  const auto add = [&](const NodePair& pair, double stiffness) {
    const double length = (surface.nodes[pair[0]] - surface.nodes[pair[1]]).norm();
    network.springs.push_back({pair[0], pair[1], length, stiffness});
  };
  for (const auto& pair : edges) add(pair, structural);
  network.structural_count = edges.size();
  if (bending_ratio <= 0) return;
  const auto neighbours = geometry::neighbours_of(surface.nodes.size(), edges);
  const auto pairs = geometry::second_neighbours_of(neighbours, kMaxSprings);
  for (const auto& pair : pairs) add(pair, bending_ratio * structural);
  network.bending_count = pairs.size();
}

void add_inner_springs(const geometry::TriangleSurface& surface, const scene::Tissue& tissue,
                       double inner_ratio, SpringNetwork& network) {
  const std::size_t surface_count = surface.nodes.size();
  double length_sum = 0;
  for (std::uint32_t i = 0; i < surface_count; ++i) {
    const Vec3& node = surface.nodes[i];
    const std::size_t inside = nearest(network.virtual_nodes, node);
    const double length = (node - network.virtual_nodes[inside]).norm();
    network.springs.push_back({i, static_cast<std::uint32_t>(surface_count + inside), length, 0});
    length_sum += length;
  }
  network.inner_count = surface_count;
  const double radius = length_sum / static_cast<double>(surface_count);
  const double per_area = inner_ratio * membrane_stiffness(tissue) / (radius * radius);
  for (std::size_t i = 0; i < surface_count; ++i) {
    network.springs[network.springs.size() - surface_count + i].stiffness =
        per_area * network.node_areas[i];
  }
}

}  // namespace

SpringFamily SpringNetwork::family(std::size_t spring) const {
  if (spring < structural_count) return SpringFamily::kStructural;
  return spring < structural_count + bending_count ? SpringFamily::kBending : SpringFamily::kInner;
}

/// The centroid of one or two nodes lies on the surface, where inner springs have no length.
constexpr std::size_t kLeastInSection = 3;

std::vector<Vec3> place_virtual_nodes(const geometry::TriangleSurface& surface, std::size_t count) {
  const Vec3 axis = geometry::dominant_axis(surface.nodes);
  double low = std::numeric_limits<double>::max(), high = -low;
  for (const Vec3& p : surface.nodes) {
    low = std::min(low, axis.dot(p));
    high = std::max(high, axis.dot(p));
  }
  std::vector<Vec3> sums(count, Vec3::Zero());
  std::vector<std::size_t> sizes(count, 0);
  for (const Vec3& p : surface.nodes) {
    const double fraction = (axis.dot(p) - low) / std::max(high - low, 1e-300);
    const auto section =
        std::min(count - 1, static_cast<std::size_t>(fraction * static_cast<double>(count)));
    sums[section] += p;
    ++sizes[section];
  }
  std::vector<Vec3> nodes;
  Vec3 all = Vec3::Zero();
  for (std::size_t s = 0; s < count; ++s) {
    all += sums[s];
    if (sizes[s] >= kLeastInSection) nodes.push_back(sums[s] / static_cast<double>(sizes[s]));
  }
  if (nodes.empty()) nodes.push_back(all / static_cast<double>(surface.nodes.size()));
  return nodes;
}

SpringNetwork build_spring_network(const geometry::TriangleSurface& surface,
                                   const scene::Tissue& tissue, const scene::Springs& springs) {
  PALPATE_DEMAND(!surface.nodes.empty() && !surface.triangles.empty());
  scene::check_spring_count(surface, springs);
  SpringNetwork network;
  network.node_areas.assign(surface.nodes.size(), 0);
  for (const auto& triangle : surface.triangles) {
    const double third = geometry::area_vector(surface.nodes, triangle).norm() / 3;
    for (const std::uint32_t node : triangle) network.node_areas[node] += third;
  }
  add_membrane_springs(surface, tissue, springs.bending_ratio, network);
  if (springs.inner_ratio > 0 && springs.virtual_nodes > 0) {
    network.virtual_nodes = place_virtual_nodes(surface, springs.virtual_nodes);
    add_inner_springs(surface, tissue, springs.inner_ratio, network);
  }
  return network;
}

}  // namespace palpate::deformation
