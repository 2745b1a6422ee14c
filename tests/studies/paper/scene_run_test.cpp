#include "studies/paper/scene_run.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "modules/core/data_folder.h"
#include "modules/scene/scene_reader.h"
#include "studies/paper/findings.h"
#include "studies/paper/shape_files.h"
#include "tests/scratch_folder.h"
#include "tests/studies/paper/numbers.h"

namespace palpate::paper {
namespace {

const std::filesystem::path kScenes = data_file("scenes");

/// Five nodes 10 cm apart on the x axis, the fourth fixed, and a virtual one.
SurfaceTopology row_of_nodes() {
  SurfaceTopology topology;
  topology.surface_node_count = 5;
  for (int i = 0; i < 6; ++i) {
    topology.rest_positions.insert(topology.rest_positions.end(), {0.1f * float(i), 0, 0});
  }
  topology.fixed_nodes = {3};
  topology.triangles = {{0, 1, 2}};
  topology.springs = {{0, 5, SpringFamily::kInner}};
  return topology;
}

TEST_CASE("far field: the mean displacement of free surface nodes beyond half the extent") {
  // Oracle: by hand. Extent 0.4 m, so from x = 0 nodes at 0.2 and 0.4 m count (0.3 is fixed).
  const auto topology = row_of_nodes();
  const FarField field(topology);
  NodePositions nodes;
  nodes.positions = topology.rest_positions;
  const Vec3 probe(-1e-3, 0, 0);
  CHECK(field.displacement(nodes, probe) == Approx(0).margin(1e-12));
  nodes.positions[3 * 0 + 1] = 7;      // near the probe
  nodes.positions[3 * 2 + 1] = 3e-3f;  // far
  nodes.positions[3 * 3 + 1] = 7;      // fixed
  nodes.positions[3 * 4 + 2] = 5e-3f;  // far
  nodes.positions[3 * 5 + 2] = 7;      // virtual
  CHECK(field.displacement(nodes, probe) == Approx(4e-3).epsilon(1e-6));
}

TEST_CASE("scene run: one sample per deformation period, as the pipeline alone gives them") {
  // Oracle: the pipeline driven directly.
  const auto scene = scene::load_scene(kScenes / "ball_squeeze.yaml");
  std::ostringstream log;
  report::Progress progress(log, [] { return false; });
  const auto samples = run_scene(scene, 0.1, progress);
  REQUIRE(samples.size() == 25);
  CHECK(samples.back().time == Approx(0.1));
  auto pipeline = session::load_session(scene);
  pipeline.run_until(0.1 - 0.5e-9);
  CHECK(samples.back().volume == pipeline.node_positions(0).volume);

  int seen = 0;
  CHECK(run_scene(scene, 0.1, progress, [&](const auto&, const auto&) {
          return ++seen < 3;
        }).size() == 3);
}

TEST_CASE("scene run: the extremes are those of the samples, and the file holds them") {
  // Oracle: by hand.
  Sample low, high;
  low.time = 1;
  low.volume = 0.9;
  low.target_volume = high.target_volume = high.volume = 1;
  high.force = 2;
  CHECK(worst_volume_error({low, high}) == Approx(0.1));
  CHECK(greatest_force({low, high}) == 2);
  const ScratchFolder folder;
  write_samples({low, high}, folder / "s.csv");
  const auto rows = testing::numbers_in(folder / "s.csv");
  REQUIRE(rows.size() == 2);
  CHECK(rows[0][1] == Approx(0.9));
  CHECK(rows[0][2] == Approx(-0.1));
  CHECK(rows[1][4] == 2);
  CHECK(model_key("mass_spring") == "mass_spring");
}

TEST_CASE("shape files: nodes with their kinds, triangles and springs") {
  // Oracle: by hand.
  const ScratchFolder folder;
  const auto topology = row_of_nodes();
  write_topology(topology, folder.path(), "row", /*springs=*/true);
  write_nodes(topology, topology.rest_positions, folder.path(), "row");
  CHECK(text_in(folder / "row_triangles.csv") == "a,b,c\n0,1,2\n");
  CHECK(text_in(folder / "row_springs.csv") == "family,a,b\n2,0,5\n");
  const auto nodes = testing::numbers_in(folder / "row_nodes.csv");
  REQUIRE(nodes.size() == 6);
  for (std::size_t i = 0; i < 6; ++i) CHECK(nodes[i][6] == (i == 3 ? 1 : i == 5 ? 2 : 0));
}

TEST_CASE("findings: printed beside the paper's value, and written") {
  // Oracle: by hand.
  const Findings findings{{"Figure 9", "speed [m/s]", ">= 3", "4"}, {"Figure 9", "size", "", "5"}};
  std::ostringstream out;
  print(findings, out);
  CHECK(out.str() == "Figure 9  speed [m/s]  4   (paper: >= 3)\nFigure 9  size         5\n");
  const ScratchFolder folder;
  write(findings, folder / "f.csv");
  CHECK(text_in(folder / "f.csv") ==
        "figure,quantity,paper,measured\nFigure 9,speed [m/s],>= 3,4\nFigure 9,size,,5\n");
}

}  // namespace
}  // namespace palpate::paper
