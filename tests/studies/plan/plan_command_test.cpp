#include "studies/plan/plan_command.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/scene/scene_reader.h"
#include "tests/studies/chart/folders.h"

namespace palpate::plan {
namespace {

std::filesystem::path write_scene(const std::filesystem::path& folder, const std::string& needs) {
  std::filesystem::copy_file(data_file("scenes/meshes/ball.ply"), folder / "ball.ply");
  std::ofstream(folder / "scene.yaml") << R"(palpate_scene: 1
organs:
  - name: ball
    mesh: {file: ball.ply, nodes: 250}
    fixed:
      - box: {min_m: [-1, -1, -1], max_m: [1, 1, -0.03]}
probes:
  - name: tip
    shape: {sphere: {radius_m: 0.01}}
    device:
      scripted:
        start_m: [0, 0, 0.062]
        moves:
          - {to_m: [0, 0, 0.052], duration_s: 0.5}
)" << needs;
  return folder / "scene.yaml";
}

TEST_CASE("plan command: it writes a scene that can be read, or says what would be needed") {
  // Oracle: the written scene's model, mesh and rate are those of the line 'chosen'; exit codes.
  const chart::testing::WorkFolder folder;
  PlanOptions options;
  options.seconds = 0.5;
  options.scene = write_scene(folder.path, "needs: {force_error: 5, step_hz: 50}\n");
  std::ostringstream out, log;
  REQUIRE(run_plan(options, out, log) == kExitDone);
  const auto planned = scene::load_scene(folder.path / "scene.planned.yaml");
  CHECK_THAT(out.str(), Catch::Contains(std::to_string(planned.organs[0].mesh.nodes) + " nodes"));
  CHECK(planned.rates.deformation >= 50);
  CHECK_THAT(log.str(),
             Catch::Matches("(.|\\n)*reference: [0-9]+ nodes; a coarser one of [0-9]+ differs"
                            " by [0-9.]+% of the force(.|\\n)*"));

  std::ofstream(options.scene, std::ios::app) << "\n";
  const chart::testing::WorkFolder strict;
  options.scene = write_scene(strict.path, "needs: {volume_error: 1.0e-12, step_hz: 50}\n");
  std::ostringstream refused;
  CHECK(run_plan(options, refused, log) == kExitFailed);
  CHECK_THAT(refused.str(), Catch::Contains("nothing meets the needs. What would:"));
  CHECK_FALSE(std::filesystem::exists(strict.path / "scene.planned.yaml"));
}

TEST_CASE("plan command: a scene without needs is refused") {
  // Oracle: the message.
  const chart::testing::WorkFolder folder;
  std::ostringstream out, log;
  CHECK_THROWS_WITH(run_plan({write_scene(folder.path, ""), {}, 1}, out, log),
                    Catch::Contains("key 'needs' asks for nothing"));
}

TEST_CASE("plan command: forces of probes that do not touch yet are not judged") {
  // Oracle: the tip of 10 mm begins 62 mm from the middle of a ball of 50 mm and has moved less
  // than its 2 mm of air after 0.1 s.
  const chart::testing::WorkFolder folder;
  std::ostringstream out, log;
  CHECK_THROWS_WITH(
      run_plan({write_scene(folder.path, "needs: {force_error: 5}\n"), {}, 0.1}, out, log),
      Catch::Contains("no probe touches the organ in the first 0.1 s"));
  CHECK_FALSE(std::filesystem::exists(folder.path / "scene.planned.yaml"));
}

}  // namespace
}  // namespace palpate::plan
