#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "bench/solids/pressed_solid.h"
#include "bench/solids/step_cost.h"
#include "deformation/steppers/implicit_solid.h"
#include "modules/core/error.h"
#include "modules/geometry/organ_shape.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/runtime/program.h"
#include "modules/scene/schema.h"

namespace palpate::solids_bench {
namespace {

constexpr double kStep = 0.01;  // [s]

struct Load {
  double depth = 0, reference = 0;  // [m], [N]
};

/// Reference forces at ν = 0.499.
const std::vector<Load> kBallLoads{
    {0.01, 0.799225}, {0.02, 2.50682}, {0.03, 5.24541}, {0.04, 9.63761}};
const std::vector<Load> kBlockLoads{
    {0.002, 0.0514788}, {0.004, 0.135726}, {0.006, 0.23081}, {0.008, 0.324873}};

scene::Organ organ_of(scene::Model model) {
  scene::Organ organ;
  organ.name = "solid";
  organ.model = model;
  organ.tissue.youngs_modulus = 5e3;
  organ.tissue.density = 1060;
  organ.tissue.drag = 20;
  organ.solid.poisson_ratio = model == scene::Model::kCorotational ? 0.45 : 0.499;
  return organ;
}

void print_loads(PressedSolid& solid, const std::vector<Load>& loads) {
  std::printf("%8s %9s %9s %8s %9s %6s %8s %8s\n", "depth mm", "force N", "reference", "error %",
              "V/V0", "iter.", "ms/step", "factor");
  for (const Load& load : loads) {
    const Rest rest = solid.press_to(load.depth);
    std::printf("%8.1f %9.5f %9.5f %8.2f %9.5f %6.1f %8.3f %8.2f%s\n", 1e3 * rest.depth, rest.force,
                load.reference, 100 * (rest.force / load.reference - 1), rest.volume_ratio,
                rest.iterations, 1e3 * rest.seconds_per_step, kStep / rest.seconds_per_step,
                rest.settled ? "" : "  moves");
    std::fflush(stdout);
  }
}

void run(const std::string& name, scene::Model model, const std::string& size) {
  scene::Organ organ = organ_of(model);
  const bool ball = name == "A";
  if (!ball) organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, 1e-6)});
  const auto mesh = ball
                        ? geometry::mesh_ball(0.05, geometry::BallPart::kWhole, size)
                        : geometry::mesh_block(Vec3(-0.04, -0.04, 0), Vec3(0.04, 0.04, 0.08), size);
  PressedSolid solid(
      organ, mesh, ball ? ball_plates(0.05) : sphere_over(0.005, 0.08),
      [&](const deformation::OrganModel& built) { return make_dynamics(organ, built, kStep); },
      kStep);
  std::printf("\n%s %s, size %s: %zu nodes, %zu of the surface, %zu tetrahedra\n", name.c_str(),
              scene::word_of(model), size.c_str(), solid.model().node_count(),
              solid.model().surface_node_count, solid.model().mesh().tetrahedra.size());
  print_loads(solid, ball ? kBallLoads : kBlockLoads);
}

}  // namespace
}  // namespace palpate::solids_bench

int main(int argc, char** argv) {
  using namespace palpate;
  CLI::App app("Implicit solids of linear tetrahedra: errors of force, and what a step costs.",
               "palpate-bench-solids");
  std::string mesh;
  std::vector<std::string> ball_sizes{"0.012", "0.0085", "0.006"};
  std::vector<std::string> block_sizes{"0.0015 + 0.18*Sqrt(x*x+y*y+(0.08-z)*(0.08-z))",
                                       "0.001 + 0.16*Sqrt(x*x+y*y+(0.08-z)*(0.08-z))",
                                       "0.0007 + 0.14*Sqrt(x*x+y*y+(0.08-z)*(0.08-z))"};
  app.add_option("--cost", mesh, "Only the cost of a step, of this mesh of tetrahedra");
  app.add_option("--ball", ball_sizes, "Edge lengths [m] of case A, the ball between plates");
  app.add_option("--block", block_sizes, "Edge lengths [m] of case D, the indented block");
  return runtime::run_program(app, argc, argv, [&] {
    for (const auto model : {scene::Model::kCorotational, scene::Model::kNodalPressure}) {
      if (!mesh.empty()) {
        solids_bench::print_step_cost(model, geometry::read_tetrahedra(mesh));
        continue;
      }
      for (const auto& size : ball_sizes) solids_bench::run("A", model, size);
      for (const auto& size : block_sizes) solids_bench::run("D", model, size);
    }
    return kExitDone;
  });
}
