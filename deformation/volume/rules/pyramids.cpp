#include "deformation/volume/rules/pyramids.h"

#include <numeric>

#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

/// The one nearest to the centre of the surface at rest.
std::uint32_t central_virtual_node(const OrganModel& model) {
  const auto& nodes = model.rest_positions;
  const auto count = static_cast<std::uint32_t>(model.surface_node_count);
  Vec3 centre = Vec3::Zero();
  for (std::uint32_t i = 0; i < count; ++i) centre += nodes[i] * model.network().node_areas[i];
  centre /=
      std::accumulate(model.network().node_areas.begin(), model.network().node_areas.end(), 0.0);
  std::uint32_t nearest = count;
  for (std::uint32_t v = count; v < nodes.size(); ++v) {
    if ((nodes[v] - centre).norm() < (nodes[nearest] - centre).norm()) nearest = v;
  }
  return nearest;
}

}  // namespace

std::vector<Pyramid> build_pyramids(const OrganModel& model) {
  PALPATE_DEMAND(model.node_count() > model.surface_node_count);
  const auto& nodes = model.rest_positions;
  const std::uint32_t apex = central_virtual_node(model);
  std::vector<Pyramid> pyramids;
  double area = 0;
  for (const auto& triangle : model.triangles) {
    const auto& [i, j, k] = triangle;
    Pyramid pyramid{{i, j, k, apex}, 0, geometry::area_vector(nodes, triangle).norm()};
    pyramid.rest_volume = evaluate_pyramid(pyramid, nodes).volume;
    area += pyramid.area_share;
    pyramids.push_back(pyramid);
  }
  for (Pyramid& pyramid : pyramids) pyramid.area_share /= area;
  return pyramids;
}

PyramidVolume evaluate_pyramid(const Pyramid& pyramid, const std::vector<Vec3>& positions) {
  const Vec3& apex = positions[pyramid.nodes[3]];
  const Vec3 a = positions[pyramid.nodes[0]] - apex, b = positions[pyramid.nodes[1]] - apex,
             c = positions[pyramid.nodes[2]] - apex;
  PyramidVolume result;
  result.gradient[0] = b.cross(c) / 6;
  result.gradient[1] = c.cross(a) / 6;
  result.gradient[2] = a.cross(b) / 6;
  result.gradient[3] = -(result.gradient[0] + result.gradient[1] + result.gradient[2]);
  result.volume = a.dot(result.gradient[0]);
  return result;
}

}  // namespace palpate::deformation
