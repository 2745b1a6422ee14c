#include <array>

#include "modules/scene/scene_reader.h"
#include "palpate/session/in_process.h"
#include "studies/paper/figures.h"
#include "studies/paper/shape_files.h"

namespace palpate::paper {
namespace {

/// As the paper counts: 550 nodes; a closed surface of genus 0 has 2 V − 4 triangles.
struct Organ {
  const char* name;
  const char* scene;
  const char* paper;
};
constexpr std::array<Organ, 2> kOrgans{
    {{"stomach", "stomach_probe.yaml", "550 nodes, 1,096 triangles"},
     {"liver", "liver_probe.yaml", "550 nodes, 1,084 triangles"}}};

std::string counts(const SurfaceTopology& topology) {
  const std::size_t nodes = topology.rest_positions.size() / 3;
  return std::to_string(topology.surface_node_count) + " surface + " +
         std::to_string(nodes - topology.surface_node_count) + " virtual nodes, " +
         std::to_string(topology.triangles.size()) + " triangles";
}

std::string springs_by_family(const SurfaceTopology& topology) {
  std::array<std::size_t, 3> count{};
  for (const auto& spring : topology.springs) ++count[static_cast<std::size_t>(spring.family)];
  return std::to_string(count[0]) + " structural, " + std::to_string(count[1]) + " bending, " +
         std::to_string(count[2]) + " inner";
}

}  // namespace

Findings make_spring_figure(const FigureOptions& options, report::Progress& progress) {
  progress.begin("Figure 1: springs of stomach and liver");
  Findings findings;
  for (const Organ& organ : kOrgans) {
    const auto scene = scene::load_scene(options.scenes / organ.scene);
    const auto session = session::load_session(scene);
    const SurfaceTopology& topology = session.surface(0);
    const std::string name = std::string("figure1_") + organ.name;
    write_topology(topology, options.out, name, /*springs=*/true);
    write_nodes(topology, topology.rest_positions, options.out, name);
    findings.push_back({"Figure 1", std::string(organ.name) + ": nodes and triangles", organ.paper,
                        counts(topology)});
    findings.push_back(
        {"Figure 1", std::string(organ.name) + ": springs", "", springs_by_family(topology)});
    progress.at(double(findings.size()) / 2, double(kOrgans.size()), "organs");
  }
  return findings;
}

}  // namespace palpate::paper
