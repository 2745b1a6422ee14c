// Force under a small sphere at random places of a solid organ: what tetrahedra that are small
// where it touches are worth, linear and quadratic ones, error against processor time. All meshes
// are halvings of one, so all have the same surface. The truth is quadratic elements (P2/P1) at
// rest, on two of them.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <random>

#include "deformation/model/organ_model.h"
#include "modules/core/error.h"
#include "modules/geometry/organ_shape.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/geometry/winding_number.h"
#include "modules/runtime/program.h"
#include "modules/scene/assets.h"
#include "modules/scene/models.h"
#include "studies/chart/case_parts.h"
#include "studies/chart/equilibria.h"
#include "studies/report/measures.h"
#include "studies/report/table_file.h"
#include "studies/rigs/poked_organ.h"
#include "studies/rigs/pressed_organ.h"

using namespace palpate;

namespace {

constexpr double kRate = 100;                                        // [Hz]
constexpr double kSpeed = 10e-3;                                     // of the press [m/s]
constexpr double kYoungsModulus = 5e3, kDensity = 1060, kDrag = 40;  // [Pa], [kg/m³], [1/s]
constexpr std::size_t kSurfaceNodes = 300;
constexpr std::array kDepths{3e-3, 6e-3, 9e-3};  // [m]

struct Options {
  std::string organ = "liver";
  int sites = 10;
  int seed = 1;
  double radius_mm = 8;
  std::string out;
};

/// Edges of the touched part, as parts of the sphere's radius, and how they grow. No edge: as it
/// is.
struct Mesh {
  double edge_over_radius, growth;
  double plateau_over_radius;  ///< distance from the touched place up to which they do not grow
};
constexpr Mesh kTruth{0.5, 0.8, 0};
constexpr Mesh kFinerTruth{0.4, 0.65, 0};

struct Candidate {
  const char* name;
  const char* model;
  Mesh mesh;
};
constexpr std::array kCandidates{
    Candidate{"springs, as shipped", "implicit_volume", {0, 0, 0}},
    Candidate{"linear, as shipped", "nodal_pressure", {0, 0, 0}},
    Candidate{"linear, R/2, 0.5", "nodal_pressure", {0.5, 0.5, 1}},
    Candidate{"linear, R/3, 0.5", "nodal_pressure", {1.0 / 3, 0.5, 1}},
    Candidate{"quadratic, as shipped", "quadratic_pressure", {0, 0, 0}},
    Candidate{"quadratic, 1.4 R, 1", "quadratic_pressure", {1.4, 1, 0.5}},
    Candidate{"quadratic, R, 1", "quadratic_pressure", {1, 1, 0.5}},
    Candidate{"quadratic, 0.7 R, 1", "quadratic_pressure", {0.7, 1, 0.5}}};
constexpr int kBarEvery = 5;  // sites, from which the finer truth is computed, too

struct Site {
  Vec3 touched = Vec3::Zero();
  Vec3 into = Vec3::UnitY();
};

struct Answer {
  std::array<double, kDepths.size()> force{};  // [N]
  std::array<double, kDepths.size()> estimated_error{};
  std::size_t nodes = 0, tetrahedra = 0;
  double cost = 0;  // processor seconds of deformation per simulated second
};

class Bench {
 public:
  explicit Bench(const Options& options)
      : radius_(1e-3 * options.radius_mm),
        place_(options.organ == "liver" ? rigs::kOnLiver : rigs::kOnStomach),
        organ_(rigs::poked_organ(place_)),
        surface_(rigs::surface_of(organ_, kSurfaceNodes)),
        mesh_(geometry::fill_surface(surface_, geometry::mean_edge_length(surface_))) {}

  /// Places on the skin, area by area alike: 15 mm from what is fixed, 25 mm thick at least, and
  /// free for the sphere to come along the normal.
  std::vector<Site> random_sites(int count, int seed) const {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<double> areas;
    for (const auto& [a, b, c] : surface_.triangles) {
      areas.push_back(normal_of(a, b, c).norm());
    }
    std::discrete_distribution<std::size_t> any_triangle(areas.begin(), areas.end());
    std::vector<Site> sites;
    while (sites.size() < static_cast<std::size_t>(count)) {
      const auto& [a, b, c] = surface_.triangles[any_triangle(random)];
      double u = uniform(random), v = uniform(random);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      Site site;
      site.touched =
          (1 - u - v) * surface_.nodes[a] + u * surface_.nodes[b] + v * surface_.nodes[c];
      site.into = -normal_of(a, b, c).normalized();
      if (is_fit(site)) sites.push_back(site);
    }
    return sites;
  }

  Answer press(const Site& site, const Candidate& candidate,
               const std::function<void()>& keep_going) const {
    const bool springs = !scene::is_solid(candidate.model);
    geometry::OrganShape shape =
        springs ? geometry::OrganShape(surface_) : geometry::shape_of(halved(site, candidate.mesh));
    if (scene::is_quadratic(candidate.model)) shape = geometry::with_edge_nodes(shape);
    scene::Scene scene;
    // Springs as calibrated for solids (docs/calibration.md), by the ball of the same volume.
    const double volume = geometry::enclosed_volume(surface_.nodes, surface_.triangles);
    scene.organs.push_back(chart::solid_organ({candidate.model},
                                              std::cbrt(3 * volume / (4 * std::numbers::pi)),
                                              chart::kVirtualNodes, kYoungsModulus, kDensity));
    scene::Organ& organ = scene.organs[0];
    organ.fixed = organ_.fixed;
    organ.tissue.drag = kDrag;
    scene.rates.deformation = kRate;
    scene.probes.push_back({"tip", scene::SphereShape{radius_}, 0.0, scene::ScriptedDevice{}});
    const auto centre = [&](double depth) -> Vec3 {
      return site.touched + (depth - radius_) * site.into;
    };
    rigs::PressedOrgan pressed(scene, shape, {{centre(-1e-3), Quat::Identity()}});
    Answer answer;
    for (std::size_t i = 0; i < kDepths.size(); ++i) {
      pressed.move_and_settle({centre(kDepths[i])}, kSpeed, keep_going);
      answer.force[i] = -pressed.force(0).dot(site.into);
      answer.estimated_error[i] = pressed.estimated_force_error(0);
    }
    answer.nodes = shape.node_count();
    answer.tetrahedra = shape.tetrahedra.size();
    answer.cost = pressed.busy() / pressed.time();
    return answer;
  }

  /// None if Newton's method fails.
  std::optional<Answer> truth(const Site& site, const Mesh& mesh,
                              const std::function<void()>& keep_going) const {
    const deformation::TaylorHoodElements solid(
        deformation::make_quadratic(halved(site, mesh)),
        deformation::ElasticConstants(kYoungsModulus, scene::Solid().poisson_ratio), kDensity);
    std::vector<char> constrained;
    for (const Vec3& node : solid.mesh().nodes) {
      constrained.insert(constrained.end(), 3, deformation::is_fixed(organ_, node));
    }
    const auto found = chart::press_at_rest(
        solid, constrained,
        {site.touched, site.into, radius_, {kDepths.begin(), kDepths.end()}, {}}, keep_going);
    if (found.size() < kDepths.size()) return {};
    Answer answer;
    for (std::size_t i = 0; i < kDepths.size(); ++i) answer.force[i] = found[i].force;
    answer.nodes = solid.mesh().nodes.size();
    return answer;
  }

 private:
  Vec3 normal_of(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return (surface_.nodes[b] - surface_.nodes[a]).cross(surface_.nodes[c] - surface_.nodes[a]);
  }

  bool is_fit(const Site& site) const {
    constexpr double kFromFixed = 15e-3, kThick = 25e-3, kWay = 20e-3;
    for (const Vec3& node : surface_.nodes) {
      if (deformation::is_fixed(organ_, node) && (node - site.touched).norm() < kFromFixed) {
        return false;
      }
      // The sphere on its way may touch nothing else; a few facets lean into its path at the end.
      for (double away = 2e-3; away < kWay; away += 2e-3) {
        const Vec3 centre = site.touched - (away + radius_) * site.into;
        if ((node - centre).norm() < radius_) return false;
      }
    }
    for (double depth = 2e-3; depth < kThick; depth += 2e-3) {
      const Vec3 x = site.touched + depth * site.into;
      if (geometry::winding_number(x, surface_.nodes, surface_.triangles) < 0.5) return false;
    }
    return true;
  }

  geometry::TetMesh halved(const Site& site, const Mesh& mesh) const {
    if (mesh.edge_over_radius == 0) return mesh_;
    scene::Organ organ = organ_;
    organ.pose = {};  // the mesh is placed already
    organ.solid.refine = {{scene::SphereRegion{site.touched, mesh.plateau_over_radius * radius_}},
                          mesh.edge_over_radius * radius_,
                          mesh.growth};
    return scene::refined(mesh_, organ);
  }

  double radius_;
  rigs::PokedPlace place_;
  scene::Organ organ_;
  geometry::TriangleSurface surface_;
  geometry::TetMesh mesh_;
};

/// The value that 95 of 100 do not exceed. @param values  not empty
double not_exceeded_by_95(std::vector<double> values) {
  std::ranges::sort(values);
  return values[(95 * values.size() + 99) / 100 - 1];
}

std::string middle_half(std::vector<double> values) {
  std::ranges::sort(values);
  if (!(values.back() > 0)) return "none";
  return fmt::format("{:.2f} to {:.2f}", values[values.size() / 4], values[3 * values.size() / 4]);
}

int run(const Options& options) {
  const Bench bench(options);
  const auto keep_going = [] {};
  std::printf("%s, sphere of %g mm, errors of force at 3 / 6 / 9 mm (as it runs, estimated)\n",
              options.organ.c_str(), options.radius_mm);
  std::fflush(stdout);
  std::array<std::vector<double>, kCandidates.size()> errors, costs, nodes, effectivities;
  std::vector<double> bars;
  std::optional<report::TableFile> table;
  if (!options.out.empty()) {
    table.emplace(options.out, std::vector<std::string>{
                                   "organ", "place", "mesh", "nodes", "tetrahedra", "cost_s_per_s",
                                   "depth_m", "force_n", "true_force_n", "estimated_error"});
  }
  int number = 0;
  for (const Site& site : bench.random_sites(options.sites, options.seed)) {
    std::printf("(%.4f %.4f %.4f) m:", site.touched.x(), site.touched.y(), site.touched.z());
    std::fflush(stdout);
    const auto truth = bench.truth(site, kTruth, keep_going);
    const auto finer = number++ % kBarEvery == 0 ? bench.truth(site, kFinerTruth, keep_going)
                                                 : std::optional<Answer>();
    if (!truth) {
      std::printf(" no equilibrium was found\n");
      continue;
    }
    for (std::size_t i = 0; i < kDepths.size(); ++i) {
      std::printf(" %.4f N", truth->force[i]);
      if (!finer) continue;
      bars.push_back(std::abs(truth->force[i] / finer->force[i] - 1));
      std::printf(" (finer %.4f)", finer->force[i]);
    }
    std::printf(", %zu nodes\n", truth->nodes);
    std::fflush(stdout);
    for (std::size_t m = 0; m < kCandidates.size(); ++m) {
      const Answer found = bench.press(site, kCandidates[m], keep_going);
      std::printf("  %-21s %5zu nodes %6zu tetrahedra %.2f s/s:", kCandidates[m].name, found.nodes,
                  found.tetrahedra, found.cost);
      for (std::size_t i = 0; i < kDepths.size(); ++i) {
        const double error = found.force[i] / truth->force[i] - 1;
        errors[m].push_back(std::abs(error));
        effectivities[m].push_back(found.estimated_error[i] / std::abs(error));
        std::printf(" %+6.1f (%.1f) %%", 100 * error, 100 * found.estimated_error[i]);
        if (table) {
          table->write_row(std::vector<std::string>{
              options.organ, std::to_string(number), kCandidates[m].name,
              std::to_string(found.nodes), std::to_string(found.tetrahedra),
              fmt::format("{:.4g}", found.cost), fmt::format("{:g}", kDepths[i]),
              fmt::format("{:.8g}", found.force[i]), fmt::format("{:.8g}", truth->force[i]),
              fmt::format("{:.4g}", found.estimated_error[i])});
        }
      }
      costs[m].push_back(found.cost);
      nodes[m].push_back(static_cast<double>(found.nodes));
      std::printf("\n");
      std::fflush(stdout);
    }
  }
  if (errors[0].empty() || bars.empty()) return kExitFailed;
  if (table) table->finish();
  std::printf("\ntruth: a finer mesh differs by %.1f %% in the median, %.1f %% at most\n",
              100 * report::median(bars), 100 * std::ranges::max(bars));
  std::printf("%-21s %6s %10s %10s %10s %10s  %s\n", "mesh", "nodes", "median", "95 of 100",
              "at most", "s/s", "estimate over error, middle half");
  for (std::size_t m = 0; m < kCandidates.size(); ++m) {
    std::printf("%-21s %6.0f %8.1f %% %8.1f %% %8.1f %% %10.2f  %s\n", kCandidates[m].name,
                report::median(nodes[m]), 100 * report::median(errors[m]),
                100 * not_exceeded_by_95(errors[m]), 100 * std::ranges::max(errors[m]),
                report::median(costs[m]), middle_half(effectivities[m]).c_str());
  }
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  runtime::Program program(
      "Force under a small sphere at random places of a solid organ, on meshes that are fine "
      "there.",
      "palpate-bench-touch");
  Options options;
  program.add("--organ", options.organ, "Which").one_of({"liver", "stomach"}).shows_default();
  program.add("--sites", options.sites, "How many places").range(1, 1000).shows_default();
  program.add("--seed", options.seed, "Of the places").range(0, 1e6).shows_default();
  program.add("--radius-mm", options.radius_mm, "Of the sphere").range(1, 20).shows_default();
  program.add("--out", options.out, "Table of all forces, for scripts/plots/plot_touch.py");
  return program.run(argc, argv, [&] { return run(options); });
}
