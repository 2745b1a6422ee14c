#include "studies/plan/solid_reference.h"

#include <algorithm>
#include <limits>

#include "haptics/devices/device.h"
#include "modules/geometry/closest_points.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/scene/assets.h"
#include "studies/chart/local_refinement.h"

namespace palpate::plan {
namespace {

constexpr double kGrowth = 0.4;
constexpr double kPathRate = 50;  // [Hz]

Vec3 nearest_point(const geometry::TriangleSurface& surface, const Vec3& to) {
  Vec3 nearest = Vec3::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : surface.triangles) {
    const Vec3 point =
        geometry::closest_on_triangle(to, {surface.nodes[a], surface.nodes[b], surface.nodes[c]})
            .point;
    if ((point - to).norm() >= least) continue;
    least = (point - to).norm();
    nearest = point;
  }
  return nearest;
}

}  // namespace

geometry::OrganShape solid_reference_shape(const scene::Scene& scene, double duration,
                                           double edge) {
  scene::Organ hull = scene.organs[0];
  hull.model = "implicit_volume";
  const auto coarse = scene::load_organ(hull).surface;
  auto surface = coarse;
  for (const auto& probe : scene.probes) {
    const double radius = geometry::tip_radius(scene::form_of(probe.shape));
    std::vector<std::string> warnings;
    const auto device = haptics::make_device(probe.device, scene.haptics, warnings);
    Vec3 last = Vec3::Constant(std::numeric_limits<double>::infinity());
    for (double time = 0; radius > 0 && time <= duration; time += 1 / kPathRate) {
      const Vec3 at = device->read(time).pose.position;
      const Vec3 near = nearest_point(coarse, at);
      if ((near - at).norm() > 2 * radius || (near - last).norm() < radius / 2) continue;
      surface = chart::refine_around(std::move(surface), near, edge * radius, kGrowth);
      last = near;
    }
  }
  return geometry::shape_of(geometry::fill_surface(surface, geometry::mean_edge_length(coarse)));
}

}  // namespace palpate::plan
