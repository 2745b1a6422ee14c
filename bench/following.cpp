// A solid whose mesh follows the touch: what a change of the mesh costs and does. A sphere is
// pressed into a flat block, slides at constant depth, and circles; on a block that is the same
// everywhere the force is constant but for the mesh.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>

#include "deformation/contact/touch_follower.h"
#include "modules/core/error.h"
#include "modules/geometry/bisection.h"
#include "modules/geometry/organ_shape.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/runtime/program.h"
#include "modules/scene/models.h"
#include "studies/report/measures.h"
#include "studies/rigs/pressed_organ.h"

using namespace palpate;

namespace {

constexpr double kYoungsModulus = 5e3, kDensity = 1060, kDrag = 40;  // [Pa], [kg/m³], [1/s]

constexpr double kHalfWay = 25e-3;  // [m]
constexpr std::array kAngles{0.0, 45.0, 90.0};

Vec3 towards(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  return {std::cos(angle), std::sin(angle), 0};
}

struct Options {
  double rate = 100, radius_mm = 8, depth_mm = 4, force_error = 0.1;
  double edge_mm = 14;
  std::string model = "nodal_pressure";
  int budget = 0, changes = 0;
};

/// Of quadratic tetrahedra or of linear ones: longest edge over R, and growth.
struct Fineness {
  double edge, growth;
};

Fineness fineness_of(const Options& options) {
  using scene::Refinement;
  if (scene::is_quadratic(options.model)) {
    return {deformation::quadratic_edge_over_radius(options.force_error),
            Refinement::kQuadraticGrowth};
  }
  return {deformation::edge_over_radius(options.force_error), Refinement::kGrowth};
}

/// @param fine  as under the probe all along its way
geometry::OrganShape block(const Options& options, bool fine, double angle) {
  geometry::TetMesh mesh = geometry::mesh_block({-0.06, -0.06, -0.05}, {0.06, 0.06, 0},
                                                report::text_of("%g", 1e-3 * options.edge_mm));
  if (fine) {
    const double radius = 1e-3 * options.radius_mm;
    const Fineness wanted = fineness_of(options);
    mesh = geometry::bisected(
        mesh,
        [&](const Vec3& x) {
          const double along = std::clamp(x.dot(towards(angle)), -kHalfWay, kHalfWay);
          const double away = (x - along * towards(angle)).norm();
          return wanted.edge * radius + wanted.growth * std::max(0.0, away - 1.25 * radius);
        },
        50'000);
  }
  const geometry::OrganShape shape = geometry::shape_of(mesh);
  return scene::is_quadratic(options.model) ? geometry::with_edge_nodes(shape) : shape;
}

scene::Scene scene_of(const Options& options, bool follows) {
  scene::Scene scene;
  scene::Organ organ;
  organ.name = "block";
  organ.model = options.model;
  organ.tissue.youngs_modulus = kYoungsModulus;
  organ.tissue.density = kDensity;
  organ.tissue.drag = kDrag;
  organ.fixed = {scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.0499)}};
  organ.solid.refine.follow = follows;
  if (options.budget > 0) {
    organ.solid.refine.nodes = static_cast<std::size_t>(options.budget);
  }
  scene.organs.push_back(organ);
  scene.needs.force_error = options.force_error;
  scene.rates.deformation = options.rate;
  scene.probes.push_back(
      {"tip", scene::SphereShape{1e-3 * options.radius_mm}, 0.0, scene::ScriptedDevice{}});
  return scene;
}

class Slide {
 public:
  Slide(const Options& options, bool follows, double angle)
      : options_(options),
        pressed_(scene_of(options, follows), block(options, !follows, angle),
                 {{at(0, 0, -10), Quat::Identity()}}) {}

  Vec3 at(double x_mm, double y_mm, double depth_mm) const {
    return 1e-3 * Vec3(x_mm, y_mm, options_.radius_mm - depth_mm);
  }
  void go(const Vec3& to, double speed) {
    pressed_.move_and_settle({to}, speed, [] {});
  }

  /// One period. @returns the force upwards [N]
  double step(const Vec3& to) {
    const double before = pressed_.busy();
    pressed_.advance({{to, Quat::Identity()}});
    costs.push_back(pressed_.busy() - before);
    return pressed_.force(0).z();
  }
  rigs::PressedOrgan& pressed() { return pressed_; }

  std::vector<double> costs;  // of deformation, by period [s]

 private:
  Options options_;
  rigs::PressedOrgan pressed_;
};

double percentile(std::vector<double> values, double part) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

void measure(const Options& options, bool follows, double angle) {
  const double period = 1 / options.rate;
  Slide slide(options, follows, angle);
  {
    for (const double speed : {5.0, 10.0, 20.0, 40.0}) {
      const double c = towards(angle).x(), s = towards(angle).y();
      slide.go(slide.at(-25 * c, -25 * s, -4), 40e-3);
      slide.go(slide.at(-25 * c, -25 * s, options.depth_mm), 10e-3);
      slide.costs.clear();
      std::vector<double> forces;
      int changes = 0;
      double at_change = 0, other = 0;
      std::size_t nodes = slide.pressed().node_count();
      int since = 100;
      const int steps = static_cast<int>(50 / (speed * period));
      for (int k = 1; k <= steps; ++k) {
        const double along = -25 + 50.0 * k / steps;
        const double force = slide.step(slide.at(along * c, along * s, options.depth_mm));
        const std::size_t now = slide.pressed().node_count();
        since = now != nodes ? 0 : since + 1;
        changes += now != nodes;
        nodes = now;
        if (along > -20) {
          if (!forces.empty()) {
            double& most = since <= 1 ? at_change : other;
            most = std::max(most, std::abs(force / forces.back() - 1));
          }
          forces.push_back(force);
        }
      }
      double mean = 0;
      for (const double force : forces) mean += force / static_cast<double>(forces.size());
      const auto [low, high] = std::ranges::minmax(forces);
      std::printf("%-8s %9.0f %5.0f %6zu %8d %8.4f %7.2f %% %7.2f %% %7.2f %% %7.2f %8.2f\n",
                  follows ? "follows" : "fine", angle, speed, nodes, changes, mean,
                  100 * (high - low) / mean, 100 * at_change, 100 * other,
                  1e3 * report::median(slide.costs), 1e3 * percentile(slide.costs, 0.999));
      std::fflush(stdout);
    }
  }
}

/// A circle of 20 mm again and again at 40 mm/s, then rest: energy and volume over many changes.
void circle(const Options& options) {
  constexpr double kCircle = 10, kCircleSpeed = 40;  // [mm], [mm/s]
  Slide slide(options, true, 0);
  slide.go(slide.at(kCircle, 0, options.depth_mm), 10e-3);
  const double turn = kCircleSpeed / kCircle / options.rate;
  std::printf("%9s %9s %12s %12s %10s %10s\n", "changes", "time s", "most E [mJ]", "least E",
              "|V-V*|/V*", "diverged");
  std::size_t nodes = slide.pressed().node_count();
  double angle = 0, most = 0, least = 1e9;
  for (int changes = 0, told = 0; changes < options.changes;) {
    angle += turn;
    slide.step(slide.at(kCircle * std::cos(angle), kCircle * std::sin(angle), options.depth_mm));
    changes += slide.pressed().node_count() != nodes;
    nodes = slide.pressed().node_count();
    const auto reading = slide.pressed().read();
    most = std::max(most, 1e3 * (reading.kinetic_energy + reading.elastic_energy));
    least = std::min(least, 1e3 * (reading.kinetic_energy + reading.elastic_energy));
    if (changes < told + options.changes / 10) continue;
    std::printf("%9d %9.1f %12.5f %12.5f %10.1e %10s\n", changes, slide.pressed().time(), most,
                least, slide.pressed().volume_error(), slide.pressed().diverged() ? "yes" : "no");
    std::fflush(stdout);
    told = changes;
    most = 0;
    least = 1e9;
  }
}

int run(const Options& options) {
  if (options.changes > 0) return circle(options), kExitDone;
  std::printf("%-8s %9s %5s %6s %8s %8s %9s %9s %9s %7s %8s\n", "mesh", "direction", "mm/s",
              "nodes", "changes", "mean N", "ripple", "at change", "other", "ms", "p99.9");
  for (const double angle : kAngles) {
    for (const bool follows : {true, false}) measure(options, follows, angle);
  }
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  runtime::Program program("A solid whose mesh follows the touch: what a change costs and does.",
                           "palpate-bench-following");
  Options options;
  program.add("--rate", options.rate, "Of deformation [Hz]").range(10, 1000).shows_default();
  program.add("--radius-mm", options.radius_mm, "Of the sphere").range(0.5, 20).shows_default();
  program.add("--depth-mm", options.depth_mm, "Of the slide").range(0.5, 20).shows_default();
  program.add("--force-error", options.force_error, "Asked for").range(0.01, 1).shows_default();
  program.add("--circle", options.changes, "Circles instead, until so many changes").range(0, 1e6);
  program.add("--nodes", options.budget, "At most; 0: what is usual").range(0, 50000);
  program.add("--model", options.model, "Which")
      .one_of({"nodal_pressure", "corotational", "quadratic_pressure"})
      .shows_default();
  program.add("--edge-mm", options.edge_mm, "Of the coarse block").range(2, 50).shows_default();
  return program.run(argc, argv, [&] { return run(options); });
}
