#include "studies/chart/organ_sites.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "deformation/model/organ_model.h"
#include "modules/geometry/bisection.h"
#include "modules/geometry/closest_points.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/geometry/winding_number.h"
#include "modules/scene/assets.h"
#include "modules/scene/models.h"
#include "studies/chart/case_parts.h"
#include "studies/chart/displacement_field.h"
#include "studies/report/measures.h"
#include "studies/truth/force_truth.h"

namespace palpate::chart {
namespace {

constexpr std::size_t kSurfaceNodes = 300;
constexpr double kPressSpeed = 10e-3;  // of the press [m/s]
constexpr double kSiteDrag = 40;       // [1/s]
constexpr double kClearRadius = 8e-3;  // [m]
constexpr std::size_t kMostCorners = 50'000;

Vec3 nearest_on(const geometry::TriangleSurface& surface, const Vec3& point) {
  Vec3 nearest = point;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : surface.triangles) {
    const auto found = geometry::closest_on_triangle(
        point, {surface.nodes[a], surface.nodes[b], surface.nodes[c]});
    const double distance = (found.point - point).norm();
    if (distance < least) least = distance, nearest = found.point;
  }
  return nearest;
}

Profile profile_of(const rigs::PressedOrgan& pressed, const std::vector<Vec3>& marks,
                   const Vec3& outward) {
  constexpr double kRounding = 1e-6;  // [m]
  const geometry::OrganShape skin = pressed.skin();
  Profile profile{};
  for (std::size_t i = 0; i < marks.size(); ++i) {
    for (const auto& [node, weight] : weights_at(skin, marks[i], kRounding)) {
      profile[i] += weight * outward.dot(pressed.position(node) - pressed.rest_position(node));
    }
  }
  return profile;
}

template <class Value>
double median_of(const std::vector<Measurement>& places, Value value) {
  std::vector<double> values;
  for (const Measurement& each : places) values.push_back(static_cast<double>(value(each)));
  return report::median(values);
}

}  // namespace

OrganSites::OrganSites(const rigs::PokedPlace& place, double radius)
    : radius_(radius),
      organ_(rigs::poked_organ(place)),
      surface_(rigs::surface_of(organ_, kSurfaceNodes)),
      mesh_(geometry::fill_surface(surface_, geometry::mean_edge_length(surface_))) {
  organ_.pose = {};  // the mesh is placed already
}

std::vector<Site> OrganSites::random(std::size_t count, unsigned seed) const {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> areas;
  for (const auto& triangle : surface_.triangles) areas.push_back(normal_of(triangle).norm());
  std::discrete_distribution<std::size_t> any_triangle(areas.begin(), areas.end());
  std::vector<Site> sites;
  while (sites.size() < count) {
    const auto& triangle = surface_.triangles[any_triangle(random)];
    double u = uniform(random), v = uniform(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    Site site;
    site.touched = (1 - u - v) * surface_.nodes[triangle[0]] + u * surface_.nodes[triangle[1]] +
                   v * surface_.nodes[triangle[2]];
    site.into = -normal_of(triangle).normalized();
    if (is_fit(site)) sites.push_back(site);
  }
  return sites;
}

Measurement OrganSites::press(const Site& site, const Setting& setting,
                              const KeepGoing& keep_going) const {
  const auto shape = shape_at(site, setting);
  rigs::PressedOrgan pressed(scene_for(setting), shape, {{centre(site, -1e-3), Quat::Identity()}});
  const auto places = marks(site);
  std::vector<Sample> samples;
  for (const double depth : kSiteDepths) {
    pressed.move_and_settle({centre(site, depth)}, kPressSpeed, keep_going);
    Sample& sample = samples.emplace_back();
    sample.load = depth;
    sample.force = -pressed.force(0).dot(site.into);
    sample.estimated_error = pressed.estimated_force_error(0);
    sample.profile = profile_of(pressed, places, -site.into);
  }
  Measurement result = summary(pressed, shape);
  result.surface_nodes = pressed.model().surface_node_count;
  result.inner_nodes = pressed.node_count() - result.surface_nodes;
  result.troubled_places = result.diverged ? 1 : 0;
  result.samples = samples;
  return result;
}

Measurement OrganSites::truth(const Site& site, const KeepGoing& keep_going) const {
  const truth::Body body{mesh_, {kYoungsModulus, kPoissonRatio}, [&](const Vec3& x) {
                           return deformation::is_fixed(organ_, x);
                         }};
  const auto at = [&](double depth) {
    return truth::Station{{centre(site, depth), centre(site, depth), radius_}};
  };
  truth::Question question{at(-1e-3), {}, marks(site)};
  for (const double depth : kSiteDepths) question.stations.push_back(at(depth));
  const auto truths = truth::force_truth(body, question, {nullptr, 1, keep_going});
  Measurement result;
  for (std::size_t k = 0; k < kSiteDepths.size(); ++k) {
    Sample& sample = result.samples.emplace_back();
    sample.load = kSiteDepths[k];
    if (k >= truths.size()) continue;
    const auto& truth = truths[k];
    sample.force = -truth.forces[0].dot(site.into);
    sample.force_bar = truth.bars[0];
    for (std::size_t i = 0; i < truth.displacements.size(); ++i) {
      sample.profile[i] = -truth.displacements[i].dot(site.into);
    }
    result.surface_nodes = truth.node_count;  // all: what the elements cost
  }
  return result;
}

Vec3 OrganSites::normal_of(const geometry::Triangle& triangle) const {
  const auto& [a, b, c] = triangle;
  return (surface_.nodes[b] - surface_.nodes[a]).cross(surface_.nodes[c] - surface_.nodes[a]);
}

bool OrganSites::is_fit(const Site& site) const {
  constexpr double kFromFixed = 15e-3, kThick = 25e-3, kWay = 20e-3;
  for (const Vec3& node : surface_.nodes) {
    if (deformation::is_fixed(organ_, node) && (node - site.touched).norm() < kFromFixed) {
      return false;
    }
    // The sphere on its way may touch nothing else; a few facets lean into its path at the end.
    for (double away = 2e-3; away < kWay; away += 2e-3) {
      const Vec3 middle = site.touched - (away + kClearRadius) * site.into;
      if ((node - middle).norm() < kClearRadius) return false;
    }
  }
  for (double depth = 2e-3; depth < kThick; depth += 2e-3) {
    const Vec3 x = site.touched + depth * site.into;
    if (geometry::winding_number(x, surface_.nodes, surface_.triangles) < 0.5) return false;
  }
  return true;
}

/// In one direction along the skin, each as far from the axis as kProfilePlaces says, then taken
/// to the surface.
std::vector<Vec3> OrganSites::marks(const Site& site) const {
  const Vec3 along = site.into.unitOrthogonal();
  std::vector<Vec3> marks;
  for (const double distance : kProfilePlaces) {
    marks.push_back(nearest_on(surface_, site.touched + distance * along));
  }
  return marks;
}

scene::Scene OrganSites::scene_for(const Setting& setting) const {
  scene::Scene scene;
  // Springs as calibrated for solids (docs/calibration.md), by the ball of the same volume.
  const double volume = geometry::enclosed_volume(surface_.nodes, surface_.triangles);
  scene.organs.push_back(solid_organ(setting, std::cbrt(3 * volume / (4 * std::numbers::pi)),
                                     kVirtualNodes, kYoungsModulus, kDensity));
  scene::Organ& organ = scene.organs[0];
  organ.fixed = organ_.fixed;
  organ.tissue.drag = kSiteDrag;
  if (setting.small == Small::kFollowing) {
    organ.solid.refine.follow = true;
    organ.solid.refine.edge_length = small_tetrahedra(setting).edge * radius_;
    organ.solid.refine.growth = small_tetrahedra(setting).growth;
  }
  scene.rates.deformation = setting.rate;
  scene.probes.push_back({"tip", scene::SphereShape{radius_}, 0.0, scene::ScriptedDevice{}});
  return scene;
}

geometry::OrganShape OrganSites::shape_at(const Site& site, const Setting& setting) const {
  geometry::TetMesh mesh = mesh_;
  if (setting.small == Small::kAtPlaces) {
    const SmallTetrahedra wanted = small_tetrahedra(setting);
    scene::Organ organ = organ_;
    organ.solid.refine = {{scene::SphereRegion{site.touched, wanted.plateau * radius_}},
                          wanted.edge * radius_,
                          wanted.growth};
    mesh = scene::refined(mesh_, organ);
  } else if (setting.small == Small::kNowhere && setting.level > 0) {
    // Halved until none is longer than that, the mean of edges is about half as long as before.
    const double longest = 1.5 * std::ldexp(geometry::mean_edge_length(surface_), -setting.level);
    mesh = geometry::bisected(
        mesh_, [&](const Vec3&) { return longest; }, kMostCorners);
  }
  return shape_for(setting, geometry::shape_of(mesh));
}

Measurement joined(const std::vector<Measurement>& places) {
  Measurement all = places.at(0);
  all.samples.clear();
  all.troubled_places = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (Sample sample : places[i].samples) {
      sample.place = static_cast<double>(i);
      all.samples.push_back(sample);
    }
    all.volume_error = std::max(all.volume_error, places[i].volume_error);
    all.troubled_places += places[i].troubled_places;
  }
  const auto count = [&](std::size_t Measurement::*member) {
    all.*member = static_cast<std::size_t>(
        median_of(places, [&](const Measurement& each) { return each.*member; }));
  };
  count(&Measurement::surface_nodes);
  count(&Measurement::inner_nodes);
  count(&Measurement::tetrahedra);
  all.cost = median_of(places, [](const Measurement& each) { return each.cost; });
  all.diverged = false;  // their forces stand as they were found; troubled_places says how many
  return all;
}

}  // namespace palpate::chart
