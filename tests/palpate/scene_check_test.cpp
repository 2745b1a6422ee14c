#include "palpate/scene_check.h"

#include <catch2/catch.hpp>

#include "modules/geometry/mesh_io.h"
#include "modules/scene/scene_file.h"
#include "modules/scene/scene_reader.h"
#include "tests/modules/geometry/tetrahedra.h"
#include "tests/palpate/ball_scene.h"

using namespace palpate;
using palpate::testing::BallScene;

TEST_CASE("scene check: counts are Euler's, volume and mass the mesh's, the touch is foreseen") {
  // Oracle: Euler's formula (E = 3N − 6, F = 2N − 4), the enclosed volume of the file; the sphere
  // of 10 mm touches the ball of 50 mm at a height of 60 mm.
  const BallScene scene(
      "scripted: {start_m: [0, 0, 0.09], moves: [{to_m: [0, 0, 0.05], duration_s: 2}]}",
      "duration_s: 4\n");
  const auto check = launcher::check_scene(scene::load_scene(scene.file()), 0.05);
  const auto ball = geometry::read_surface(scene.folder() / "ball.ply", "m");
  REQUIRE(check.organs.size() == 1);
  const auto& organ = check.organs[0];
  CHECK(organ.surface_nodes == ball.nodes.size());
  CHECK(organ.triangles == 2 * ball.nodes.size() - 4);
  CHECK(organ.structural == 3 * ball.nodes.size() - 6);
  CHECK(organ.volume == Approx(geometry::enclosed_volume(ball.nodes, ball.triangles)));
  CHECK(organ.mass == Approx(1058 * organ.volume));
  CHECK(organ.size.isApprox(Vec3::Constant(0.1), 1e-6));
  CHECK(organ.substeps * organ.largest_step >= check.period);
  REQUIRE(check.probes.size() == 1);
  CHECK(check.probes[0].shape == "sphere");
  CHECK(check.probes[0].device == "scripted");
  CHECK(check.probes[0].motion.approach.touches_at);
  CHECK(check.cost > 0);
  CHECK(check.real_time_factor() <= 1);
  CHECK_FALSE(check.troubles.any());
}

TEST_CASE("scene check: a mesh that follows is measured as in a slide, not as it jumps about") {
  // Oracle: a tip that goes to and fro by half its radius goes two radii a second, and a mesh
  // changes every quarter of one: eight a second, and a touch that begins. A tip that looked for
  // its triangle anew on each mesh would jump in every period, a hundred.
  if (geometry::testing::without_gmsh()) return;
  const auto scene = scene::load_scene(scene::scene_file("liver_touch"));
  const auto check = launcher::check_scene(scene, 1);  // of the processor: some slide on a slow one
  CHECK(check.mesh_changes > 0);
  CHECK(check.mesh_changes < 20);
}
