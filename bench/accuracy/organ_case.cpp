// Organs as solids, fixed as their scenes fix them, pressed by a sphere from the front (+y).
#include <algorithm>
#include <cmath>
#include <optional>

#include "bench/accuracy/case_parts.h"
#include "bench/accuracy/displacement_field.h"
#include "modules/core/error.h"
#include "modules/geometry/gmsh_tool.h"
#include "modules/geometry/mesh_prepare.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"

namespace palpate::accuracy {
namespace {

constexpr double kTip = 8e-3, kSpeed = 5e-3, kBeside = 0.02;  // [m], [m/s], [m]
constexpr double kDrag = 40;                                  // [1/s]

struct Press {
  const char* scene;
  double x = 0, z = 0;  ///< where [m]
};

/// Where the line along y at (x, z) first meets the surface, from the front [m].
double front_of(const geometry::TriangleSurface& surface, double x, double z) {
  std::optional<double> front;
  for (const auto& [i, j, k] : surface.triangles) {
    const Vec3 &a = surface.nodes[i], &b = surface.nodes[j], &c = surface.nodes[k];
    const double area = (b.x() - a.x()) * (c.z() - a.z()) - (c.x() - a.x()) * (b.z() - a.z());
    const double u = ((x - a.x()) * (c.z() - a.z()) - (c.x() - a.x()) * (z - a.z())) / area;
    const double v = ((b.x() - a.x()) * (z - a.z()) - (x - a.x()) * (b.z() - a.z())) / area;
    if (!(u >= 0 && v >= 0 && u + v <= 1)) continue;
    const double y = a.y() + u * (b.y() - a.y()) + v * (c.y() - a.y());
    front = std::min(front.value_or(y), y);
  }
  PALPATE_DEMAND(front.has_value());
  return *front;
}

/// 150, 550 or 2,000 nodes; a quadratic mesh a quarter of them as corners.
geometry::OrganShape organ_shape(const Setting& setting, scene::Organ organ) {
  constexpr std::array<std::size_t, 3> kNodes{150, 550, 2000};
  organ.model = scene::Model::kImplicitVolume;
  organ.mesh.nodes = kNodes[static_cast<std::size_t>(setting.level)];
  if (scene::is_quadratic(setting.model)) organ.mesh.nodes = organ.mesh.nodes / 4 + 2;
  const auto surface = scene::load_organ(organ).surface;
  if (!scene::is_solid(setting.model)) return geometry::OrganShape(surface);
  const auto edges = geometry::edges_of(surface.triangles);
  double size = 0;
  for (const auto& [a, b] : edges) size += (surface.nodes[a] - surface.nodes[b]).norm();
  return shape_for(setting, geometry::shape_of(geometry::fill_surface(
                                surface, size / static_cast<double>(edges.size()))));
}

Measurement press_organ(const Press& press, const Setting& setting, const Source& source,
                        const KeepGoing& keep_going) {
  const scene::Organ shown = scene::load_scene(source.scenes / press.scene).organs.at(0);
  const auto shape = organ_shape(setting, shown);
  const double volume = geometry::enclosed_volume(shape.surface.nodes, shape.surface.triangles);
  scene::Scene scene;
  scene.organs.push_back(solid_organ(setting, std::cbrt(3 * volume / (4 * M_PI)), kVirtualNodes,
                                     kYoungsModulus, kDensity));
  scene.organs[0].tissue.drag = kDrag;
  scene.organs[0].fixed = shown.fixed;
  scene.probes.push_back({"tip", scene::SphereShape{kTip}, 0.0, scene::ScriptedDevice{}});
  scene.rates.deformation = setting.rate;
  const double front = front_of(shape.surface, press.x, press.z) - kTip;
  std::vector<Pose> poses(1);
  poses[0].position = Vec3(press.x, front - 1e-3, press.z);
  Stage stage(scene, shape, poses);
  const double beside_front = front_of(shape.surface, press.x, press.z + kBeside);
  const auto beside = weights_at(shape, {press.x, beside_front, press.z + kBeside});
  std::vector<Sample> samples;
  for (const double depth : {3e-3, 6e-3, 9e-3}) {
    move_and_settle(stage, poses, {{press.x, front + depth, press.z}}, kSpeed, keep_going);
    Sample sample;
    sample.load = depth;
    sample.force = stage.force(0).norm();
    sample.shape = 0;
    for (const auto& [node, weight] : beside) {
      sample.shape += weight * (stage.position(node) - stage.rest_position(node)).y();
    }
    samples.push_back(sample);
    if (stage.diverged()) break;
  }
  Measurement result = summary(stage, shape);
  result.samples = samples;
  return result;
}

}  // namespace

Measurement measure_liver(const Setting& setting, const Source& source,
                          const KeepGoing& keep_going) {
  return press_organ({"liver_probe.yaml", -0.020, 0.013}, setting, source, keep_going);
}

Measurement measure_stomach(const Setting& setting, const Source& source,
                            const KeepGoing& keep_going) {
  return press_organ({"stomach_probe.yaml", 0.022, -0.004}, setting, source, keep_going);
}

}  // namespace palpate::accuracy
