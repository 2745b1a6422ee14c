#include <algorithm>
#include <cmath>
#include <limits>

#include "deformation/organ_messages.h"
#include "modules/core/error.h"
#include "modules/scene/scene_reader.h"
#include "palpate/session/in_process.h"
#include "studies/paper/figures.h"
#include "studies/paper/shape_files.h"
#include "studies/report/measures.h"
#include "studies/report/table_file.h"

namespace palpate::paper {
namespace {

constexpr int kIterations = 800;
constexpr double kRate = 500;     // [Hz]: one step of 2 ms per iteration
constexpr double kRadius = 0.05;  // [m], of the ball in ball_squeeze.yaml
constexpr double kCompression = 0.5;
constexpr double kClosingTime = 1;    // [s]; held for the rest
constexpr int kHeldIterations = 100;  // the last ones, whose largest error counts as held

struct Case {
  const char* name;
  std::string model;
  std::size_t corrections;
};
const std::array<Case, 3> kCases{{{"mass_spring", "mass_spring", 0},
                                  {"implicit_volume", "implicit_volume", 0},
                                  {"one_correction", "implicit_volume", 1}}};

scene::Scene squeeze_scene(const FigureOptions& options, const Case& method) {
  auto scene = scene::load_scene(options.scenes / "ball_squeeze.yaml");
  PALPATE_DEMAND(scene.probes.size() == 2);
  scene.organs[0].model = method.model;
  scene.organs[0].volume_corrections = method.corrections;
  scene.rates.haptics = scene.rates.collision = scene.rates.deformation = kRate;
  for (auto& probe : scene.probes) {
    auto& device = std::get<scene::ScriptedDevice>(probe.device);
    const double side = device.start.z() > 0 ? 1 : -1;
    device.start = Vec3(0, 0, side * kRadius);
    device.moves = {{Vec3(0, 0, side * kRadius * (1 - kCompression)), kClosingTime}};
  }
  return scene;
}

/// Largest distance of a surface node from the plates' axis [m].
double bulge(const NodePositions& nodes, std::size_t surface_node_count) {
  double squared = 0;
  for (std::size_t i = 0; i < surface_node_count; ++i) {
    const float* p = nodes.positions.data() + 3 * i;
    squared = std::max(squared, double(p[0]) * p[0] + double(p[1]) * p[1]);
  }
  return std::sqrt(squared);
}

struct Outcome {
  double peak = 0, held = 0;  ///< largest |V − V*|/V*
  double bulge = 0, pressure = 0, force = 0;
  int substeps = 0;
};

Outcome run(const FigureOptions& options, const Case& method, report::Progress& progress) {
  auto pipeline = session::load_session(squeeze_scene(options, method));
  const SurfaceTopology& topology = deformation::surface_message(pipeline.world(), 0);
  const std::string name = std::string("figure2_") + method.name;
  report::TableFile table(options.out / (name + ".csv"),
                          {"iteration", "volume_ratio", "volume_error", "pressure_pa",
                           "lower_force_n", "upper_force_n", "bulge_m"});
  Outcome outcome;
  outcome.substeps = pipeline.world().substeps(0, 1 / kRate);
  for (int k = 1; k <= kIterations; ++k) {
    pipeline.tick();
    const NodePositions& nodes = pipeline.node_positions(0);
    const double error = nodes.volume / nodes.target_volume - 1;
    outcome.peak = std::max(outcome.peak, std::abs(error));
    if (k > kIterations - kHeldIterations) outcome.held = std::max(outcome.held, std::abs(error));
    outcome.bulge = bulge(nodes, topology.surface_node_count);
    outcome.pressure = nodes.pressure;
    outcome.force = pipeline.contact_model(1).force().norm();
    table.write_row({double(k), 1 + error, error, nodes.pressure,
                     pipeline.contact_model(0).force().norm(), outcome.force, outcome.bulge});
    progress.at(k, kIterations, "iterations");
  }
  table.finish();
  write_topology(topology, options.out, name, /*springs=*/false);
  write_nodes(topology, pipeline.node_positions(0).positions, options.out, name);
  return outcome;
}

}  // namespace

Findings make_squeeze_figure(const FigureOptions& options, report::Progress& progress) {
  Findings findings;
  const auto add = [&](const std::string& quantity, const std::string& measured) {
    findings.push_back({"Figure 2", quantity, "", measured});
  };
  for (const Case& method : kCases) {
    progress.begin(std::string("Figure 2: ball squeezed by two planes, ") + method.name);
    const Outcome outcome = run(options, method, progress);
    const std::string name = method.name;
    add(name + ": |V-V0|/V0 peak", report::text_of("%.2e", outcome.peak));
    add(name + ": |V-V0|/V0 held", report::text_of("%.2e", outcome.held));
    add(name + ": radius of the bulge [mm], 50 at rest",
        report::text_of("%.1f", 1e3 * outcome.bulge));
    add(name + ": force of a plate [N]", report::text_of("%.2f", outcome.force));
    if (method.model != "mass_spring") {
      add(name + ": pressure [Pa]", report::text_of("%.0f", outcome.pressure));
    }
    if (outcome.substeps != 1) {
      add(name + ": sub-steps per iteration", std::to_string(outcome.substeps));
    }
  }
  return findings;
}

}  // namespace palpate::paper
