#include "studies/truth/force_truth.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <numbers>
#include <optional>

#include "deformation/model/organ_model.h"
#include "modules/geometry/bisection.h"
#include "modules/geometry/closest_points.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/scene/assets.h"
#include "studies/truth/wall_mesh.h"

namespace palpate::truth {
namespace {

constexpr double kEdge = 0.45, kGrowth = 0.7;  // of the coarser mesh: radii, and per distance
constexpr double kFiner = 1 / std::numbers::sqrt2;
/// Of the tetrahedra's longest edges: that part is halved in the finer mesh where nothing touches.
constexpr double kFarPart = 0.5;
constexpr std::size_t kMostCorners = 20'000;
/// What Newton's method and the penetration it leaves may change, of a force.
constexpr double kLeastBar = 5e-3;

/// Where probes touch the surface at rest, or come near it.
struct Place {
  Vec3 at = Vec3::Zero();
  double radius = 0;  ///< of the probe [m]
};

geometry::SegmentAndTriangle nearest(const geometry::TetMesh& mesh,
                                     const std::vector<geometry::BoundaryTriangle>& skin,
                                     const geometry::RoundedSegment& probe) {
  geometry::SegmentAndTriangle nearest;
  nearest.distance = std::numeric_limits<double>::infinity();
  for (const auto& face : skin) {
    const auto& [a, b, c] = face.nodes;
    const geometry::TriangleCorners corners{mesh.nodes[a], mesh.nodes[b], mesh.nodes[c]};
    const auto found = geometry::closest_of_segment_and_triangle(probe.a, probe.b, corners);
    if (found.distance < nearest.distance) nearest = found;
  }
  return nearest;
}

std::vector<Place> touched_places(const geometry::TetMesh& mesh, const Question& question) {
  const auto skin = geometry::boundary_triangles(mesh);
  std::vector<Place> places;
  for (const Station& station : question.stations) {
    for (const auto& probe : station) {
      // A long probe is looked at ball by ball.
      const double length = (probe.b - probe.a).norm();
      const int pieces = 1 + static_cast<int>(length / probe.radius);
      for (int k = 0; k < pieces; ++k) {
        const Vec3 centre = probe.a + (k + 0.5) / pieces * (probe.b - probe.a);
        const auto found = nearest(mesh, skin, {centre, centre, probe.radius});
        if (found.distance < 2 * probe.radius) {
          places.push_back({found.on_triangle.point, probe.radius});
        }
      }
    }
  }
  return places;
}

double longest_edge(const geometry::TetMesh& mesh, const geometry::Tetrahedron& t) {
  double longest = 0;
  for (const auto& [a, b] : geometry::kTetrahedronEdges) {
    const auto i = t[static_cast<std::size_t>(a)], j = t[static_cast<std::size_t>(b)];
    longest = std::max(longest, (mesh.nodes[i] - mesh.nodes[j]).norm());
  }
  return longest;
}

/// The length that `part` of the tetrahedra's longest edges exceed.
double exceeded_by(const geometry::TetMesh& mesh, double part) {
  std::vector<double> lengths;
  for (const auto& t : mesh.tetrahedra) lengths.push_back(longest_edge(mesh, t));
  const auto at = static_cast<std::ptrdiff_t>((1 - part) * static_cast<double>(lengths.size() - 1));
  std::nth_element(lengths.begin(), lengths.begin() + at, lengths.end());
  return lengths[static_cast<std::size_t>(at)];
}

/// @param far  longest edge anywhere [m]
geometry::TetMesh refined_at(const geometry::TetMesh& mesh, const std::vector<Place>& places,
                             double scale, double far) {
  const auto size = [&](const Vec3& x) {
    double least = far;
    for (const Place& place : places) {
      least = std::min(least, scale * (kEdge * place.radius + kGrowth * (x - place.at).norm()));
    }
    return least;
  };
  return geometry::bisected(mesh, size, kMostCorners);
}

Truth truth_between(const Equilibrium& coarse, const Equilibrium& fine) {
  Truth truth;
  for (std::size_t i = 0; i < fine.forces.size(); ++i) {
    const auto [value, bar] = extrapolated(coarse.forces[i], fine.forces[i]);
    truth.forces.push_back(value);
    truth.bars.push_back(std::max(bar, kLeastBar * value.norm()));
  }
  double sum = 0;
  for (std::size_t i = 0; i < fine.displacements.size(); ++i) {
    const auto [value, bar] = extrapolated(coarse.displacements[i], fine.displacements[i]);
    truth.displacements.push_back(value);
    sum += bar * bar;
  }
  const double count = std::max<double>(1, static_cast<double>(fine.displacements.size()));
  truth.displacement_bar = std::sqrt(sum / count);
  return truth;
}

}  // namespace

Body body_of(const scene::Organ& organ) {
  scene::Organ plain = organ;
  plain.model = "nodal_pressure";  // tetrahedra are loaded, or filled in, for any linear solid
  plain.solid.refine = {};
  plain.solid.element_size = 0;
  const auto shape = scene::load_organ(plain);
  geometry::TetMesh mesh{shape.surface.nodes, shape.tetrahedra};
  mesh.nodes.insert(mesh.nodes.end(), shape.inner_nodes.begin(), shape.inner_nodes.end());
  return {std::move(mesh),
          {organ.tissue.youngs_modulus, organ.solid.poisson_ratio},
          [organ](const Vec3& x) { return deformation::is_fixed(organ, x); }};
}

Body wall_of(const scene::Organ& organ, std::size_t* thinned) {
  auto wall = wall_under(scene::load_skin(organ), organ.tissue.wall_thickness);
  if (thinned) *thinned = wall.thinned;
  return {std::move(wall.mesh),
          {organ.tissue.youngs_modulus, 0.5},
          [organ](const Vec3& x) { return deformation::is_fixed(organ, x); },
          true};
}

Extrapolated extrapolated(const Vec3& coarse, const Vec3& fine) {
  constexpr double kUsual = 2.0 / 3;
  const Vec3 change = fine - coarse;
  return {fine + kUsual * change, change.norm()};
}

void run_all(ChunkRunner& runner, std::size_t count, const std::function<void(std::size_t)>& task) {
  std::vector<std::exception_ptr> thrown(count);
  runner.run(count, [&](std::size_t i) {
    try {
      task(i);
    } catch (...) {
      thrown[i] = std::current_exception();
    }
  });
  for (const auto& exception : thrown) {
    if (exception) std::rethrow_exception(exception);
  }
}

std::vector<Truth> force_truth(const Body& body, const Question& question, const Effort& effort) {
  const auto places = touched_places(body.mesh, question);
  const double anywhere = exceeded_by(body.mesh, 0) * effort.fineness;
  const double far = exceeded_by(body.mesh, kFarPart) * effort.fineness;
  PressedSolid coarse(refined_at(body.mesh, places, effort.fineness, anywhere), body,
                      question.stations);
  struct Reached {
    deformation::SolidState state;
    Equilibrium coarse;
    std::optional<Truth> truth;
  };
  std::vector<Reached> reached;
  auto state = coarse.rest_state();
  for (std::size_t i = 0; i < question.stations.size(); ++i) {
    const Station& from = i == 0 ? question.free : question.stations[i - 1];
    const auto at = [&](double part) {
      effort.at((static_cast<double>(i) + part) / static_cast<double>(question.stations.size()));
    };
    if (!coarse.press(from, question.stations[i], state, effort.keep_going, at)) break;
    reached.push_back({state, coarse.equilibrium(state, question.marks), {}});
  }
  const auto fine_mesh = refined_at(body.mesh, places, kFiner * effort.fineness, far);
  SerialRunner alone;
  run_all(effort.runner ? *effort.runner : alone, reached.size(), [&](std::size_t i) {
    effort.keep_going();
    PressedSolid fine(fine_mesh, body, question.stations);
    auto fine_state = fine.refined(coarse, reached[i].state);
    if (!fine.settle(question.stations[i], fine_state, effort.keep_going)) return;
    reached[i].truth =
        truth_between(reached[i].coarse, fine.equilibrium(fine_state, question.marks));
    reached[i].truth->node_count = fine.node_count();
  });
  std::vector<Truth> truths;
  for (const Reached& station : reached) {
    if (!station.truth) break;
    truths.push_back(*station.truth);
  }
  return truths;
}

}  // namespace palpate::truth
