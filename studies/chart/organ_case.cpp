// Organs as solids, fixed as their scenes fix them, pressed by a sphere from the front (+y).
#include <algorithm>
#include <cmath>
#include <optional>

#include "deformation/model/organ_model.h"
#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/scene/assets.h"
#include "modules/scene/models.h"
#include "modules/scene/scene_reader.h"
#include "studies/chart/case_parts.h"
#include "studies/chart/displacement_field.h"
#include "studies/chart/equilibria.h"
#include "studies/chart/local_refinement.h"
#include "studies/chart/reference_solutions.h"

namespace palpate::chart {
namespace {

constexpr double kTip = 8e-3, kSpeed = 5e-3, kBeside = 0.02;  // [m], [m/s], [m]
constexpr double kDrag = 40;                                  // [1/s]
constexpr std::array kDepths{3e-3, 6e-3, 9e-3};               // [m]

struct Place {
  const char* scene;
  double x = 0, z = 0;  ///< where [m]
};

constexpr Place kOnLiver{"liver_probe.yaml", -0.020, 0.013};
constexpr Place kOnStomach{"stomach_probe.yaml", 0.022, -0.004};

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

constexpr std::array<std::size_t, 3> kNodes{150, 550, 2000};

geometry::TriangleSurface surface_of(scene::Organ organ, std::size_t nodes) {
  organ.model = "implicit_volume";
  organ.mesh.nodes = nodes;
  return scene::load_organ(organ).surface;
}

/// 150, 550 or 2,000 nodes; a quadratic mesh a quarter of them as corners.
geometry::OrganShape organ_shape(const Setting& setting, const scene::Organ& organ) {
  std::size_t nodes = kNodes[static_cast<std::size_t>(setting.level)];
  if (scene::is_quadratic(setting.model)) nodes = nodes / 4 + 2;
  const auto surface = surface_of(organ, nodes);
  if (!scene::is_solid(setting.model)) return geometry::OrganShape(surface);
  return shape_for(setting, geometry::shape_of(geometry::fill_surface(
                                surface, geometry::mean_edge_length(surface))));
}

Measurement press_organ(const Place& press, const Setting& setting, const KeepGoing& keep_going) {
  const scene::Organ shown = scene::load_scene(data_file("scenes") / press.scene).organs.at(0);
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
  for (const double depth : kDepths) {
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

/// The surface of level 1, finer around the sphere: what differs from models of that level is how
/// they compute, not what.
Measurement press_at_rest(const Place& place, int level, const KeepGoing& keep_going) {
  constexpr std::array kFinest{2.4e-3, 1.6e-3}, kGrowth{0.6, 0.4};
  const auto at = static_cast<std::size_t>(level);
  const scene::Organ organ = scene::load_scene(data_file("scenes") / place.scene).organs.at(0);
  const auto coarse = surface_of(organ, kNodes[1]);
  const Vec3 touched(place.x, front_of(coarse, place.x, place.z), place.z);
  const auto surface = refine_around(coarse, touched, kFinest[at], kGrowth[at]);
  const deformation::TaylorHoodElements solid(
      deformation::make_quadratic(
          geometry::fill_surface(surface, geometry::mean_edge_length(coarse))),
      deformation::ElasticConstants(kYoungsModulus, kPoissonRatio), kDensity);
  std::vector<char> held;
  for (const Vec3& node : solid.mesh().nodes) {
    held.insert(held.end(), 3, deformation::is_fixed(organ, node));
  }
  const double z = place.z + kBeside;
  const Press press{touched,
                    Vec3::UnitY(),
                    kTip,
                    {kDepths.begin(), kDepths.end()},
                    {{place.x, front_of(coarse, place.x, z), z}}};
  Measurement result = summary(solid);
  const auto answers = chart::press_at_rest(solid, held, press, keep_going);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    Sample& sample = result.samples.emplace_back();
    sample.load = kDepths[i];
    sample.force = answers[i].force;
    sample.shape = answers[i].displacements[0].y();
  }
  return result;
}

}  // namespace

Measurement press_liver(int level, const KeepGoing& keep_going) {
  return press_at_rest(kOnLiver, level, keep_going);
}

Measurement press_stomach(int level, const KeepGoing& keep_going) {
  return press_at_rest(kOnStomach, level, keep_going);
}

Measurement measure_liver(const Setting& setting, const KeepGoing& keep_going) {
  return press_organ(kOnLiver, setting, keep_going);
}

Measurement measure_stomach(const Setting& setting, const KeepGoing& keep_going) {
  return press_organ(kOnStomach, setting, keep_going);
}

}  // namespace palpate::chart
