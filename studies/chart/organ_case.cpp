// Organs as solids, fixed as their scenes fix them, pressed by a sphere from the front (+y).
#include <cmath>

#include "deformation/model/organ_model.h"
#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/scene/models.h"
#include "studies/chart/case_parts.h"
#include "studies/chart/displacement_field.h"
#include "studies/chart/equilibria.h"
#include "studies/chart/local_refinement.h"
#include "studies/chart/reference_solutions.h"
#include "studies/rigs/poked_organ.h"

namespace palpate::chart {
namespace {

using rigs::front_of;
using rigs::PokedPlace;
using rigs::surface_of;

constexpr double kSpeed = 5e-3, kBeside = 0.02;  // [m/s], [m]
constexpr double kOrganDrag = 40;                // [1/s]
constexpr std::array kDepths{3e-3, 6e-3, 9e-3};  // [m]

constexpr std::array<std::size_t, 3> kNodes{150, 550, 2000};

/// 150, 550 or 2,000 nodes; a quadratic mesh a quarter of them as corners.
geometry::OrganShape organ_shape(const Setting& setting, const scene::Organ& organ) {
  std::size_t nodes = kNodes[static_cast<std::size_t>(setting.level)];
  if (scene::is_quadratic(setting.model)) nodes = nodes / 4 + 2;
  const auto surface = surface_of(organ, nodes);
  if (!scene::is_solid(setting.model)) return geometry::OrganShape(surface);
  return shape_for(setting, geometry::shape_of(geometry::fill_surface(
                                surface, geometry::mean_edge_length(surface))));
}

Measurement press_organ(const PokedPlace& place, const Setting& setting,
                        const KeepGoing& keep_going) {
  const scene::Organ shown = rigs::poked_organ(place);
  const auto shape = organ_shape(setting, shown);
  const double volume = geometry::enclosed_volume(shape.surface.nodes, shape.surface.triangles);
  scene::Scene scene;
  scene.organs.push_back(solid_organ(setting, std::cbrt(3 * volume / (4 * M_PI)), kVirtualNodes,
                                     kYoungsModulus, kDensity));
  scene.organs[0].tissue.drag = kOrganDrag;
  scene.organs[0].fixed = shown.fixed;
  rigs::add_poker(scene);
  scene.rates.deformation = setting.rate;
  const auto poker_at = [&](double depth) { return rigs::poker_at(shape.surface, place, depth); };
  rigs::PressedOrgan pressed(scene, shape, {{poker_at(-1e-3), Quat::Identity()}});
  const double beside_front = front_of(shape.surface, place.x, place.z + kBeside);
  const auto beside = weights_at(shape, {place.x, beside_front, place.z + kBeside});
  std::vector<Sample> samples;
  for (const double depth : kDepths) {
    pressed.move_and_settle({poker_at(depth)}, kSpeed, keep_going);
    Sample sample;
    sample.load = depth;
    sample.force = pressed.force(0).norm();
    sample.shape = 0;
    for (const auto& [node, weight] : beside) {
      sample.shape += weight * (pressed.position(node) - pressed.rest_position(node)).y();
    }
    samples.push_back(sample);
    if (pressed.diverged()) break;
  }
  Measurement result = summary(pressed, shape);
  result.samples = samples;
  return result;
}

/// The surface of level 1, finer around the sphere: what differs from models of that level is how
/// they compute, not what.
Measurement press_at_rest(const PokedPlace& place, int level, const KeepGoing& keep_going) {
  constexpr std::array kFinest{2.4e-3, 1.6e-3}, kGrowth{0.6, 0.4};
  const auto at = static_cast<std::size_t>(level);
  const scene::Organ organ = rigs::poked_organ(place);
  const auto coarse = surface_of(organ, kNodes[1]);
  const Vec3 touched(place.x, front_of(coarse, place.x, place.z), place.z);
  const auto surface = refine_around(coarse, touched, kFinest[at], kGrowth[at]);
  const deformation::TaylorHoodElements solid(
      deformation::make_quadratic(
          geometry::fill_surface(surface, geometry::mean_edge_length(coarse))),
      deformation::ElasticConstants(kYoungsModulus, kPoissonRatio), kDensity);
  std::vector<char> constrained;
  for (const Vec3& node : solid.mesh().nodes) {
    constrained.insert(constrained.end(), 3, deformation::is_fixed(organ, node));
  }
  const double z = place.z + kBeside;
  const Press press{touched,
                    Vec3::UnitY(),
                    rigs::kPokerRadius,
                    {kDepths.begin(), kDepths.end()},
                    {{place.x, front_of(coarse, place.x, z), z}}};
  Measurement result = summary(solid);
  const auto answers = chart::press_at_rest(solid, constrained, press, keep_going);
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
  return press_at_rest(rigs::kOnLiver, level, keep_going);
}

Measurement press_stomach(int level, const KeepGoing& keep_going) {
  return press_at_rest(rigs::kOnStomach, level, keep_going);
}

Measurement measure_liver(const Setting& setting, const KeepGoing& keep_going) {
  return press_organ(rigs::kOnLiver, setting, keep_going);
}

Measurement measure_stomach(const Setting& setting, const KeepGoing& keep_going) {
  return press_organ(rigs::kOnStomach, setting, keep_going);
}

}  // namespace palpate::chart
