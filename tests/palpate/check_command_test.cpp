#include "palpate/check_command.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <sstream>

#include "modules/core/error.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/triangle_surface.h"
#include "modules/scene/scene_reader.h"
#include "tests/modules/geometry/tetrahedra.h"
#include "tests/palpate/ball_scene.h"

using namespace palpate;
using Catch::Contains;
using testing::BallScene;

TEST_CASE("check: prints the resolved scene, which can be read back") {
  // Oracle: the scene reader.
  const BallScene scene;
  std::ostringstream out;
  CHECK(launcher::check_command(scene.file(), 0.05, out) == kExitDone);
  const std::string text = out.str();
  const std::string resolved = text.substr(0, text.find("\norgan ball:"));
  const auto loaded = scene::load_scene(scene.file());
  CHECK(scene::scene_digest(scene::parse_scene(resolved, scene.file())) ==
        scene::scene_digest(loaded));
}

TEST_CASE("check: counts, volume and mass are those of the mesh") {
  // Oracle: Euler's formula (E = 3N − 6, F = 2N − 4) and the enclosed volume of the file.
  const BallScene scene;
  std::ostringstream out;
  launcher::check_command(scene.file(), 0.05, out);
  const auto ball = geometry::read_surface(scene.folder() / "ball.ply", "m");
  const double volume = geometry::enclosed_volume(ball.nodes, ball.triangles);
  char measures[80];
  std::snprintf(measures, sizeof measures, "volume %.1f cm3, mass %.3f kg", 1e6 * volume,
                1058 * volume);
  CHECK_THAT(out.str(), Contains("organ ball: 642 surface nodes + 6 virtual nodes") &&
                            Contains("1280 triangles") && Contains("1920 structural") &&
                            Contains(measures));
}

TEST_CASE("check: tells sub-steps, rates, cost and the real-time factor to expect") {
  // Oracle: definition.
  const BallScene scene;
  std::ostringstream out;
  launcher::check_command(scene.file(), 0.05, out);
  CHECK_THAT(out.str(), Contains("largest step") && Contains("sub-steps of") &&
                            Contains("rates: haptics 1000 Hz, collision 250 Hz") &&
                            Contains("cost here: ") && Contains("expected real-time factor: "));
}

TEST_CASE("check: says which integrator steps the springs, who chose it and by what") {
  // Oracle: the rule. A ball of 642 nodes at 10 kPa is cheap to step explicitly.
  const BallScene scene;
  std::ostringstream out;
  launcher::check_command(scene.file(), 0.05, out);
  CHECK_THAT(out.str(), Contains("integrator symplectic_euler (automatic): passes over the springs "
                                 "per simulated second: symplectic_euler ") &&
                            Contains("backward_euler 3500\n"));
}

TEST_CASE("check: springs that are not the fitted ones are named") {
  // Oracle: docs/calibration.md. The ball's inner_ratio of 0.5 is ten times the fitted one.
  const BallScene scene;
  std::ostringstream out;
  launcher::check_command(scene.file(), 0.05, out);
  CHECK_THAT(out.str(), Contains("warning: inner_ratio 0.5 is not calibrated"));
  std::ostringstream fitted;
  std::ifstream file(scene.file());
  std::string text(std::istreambuf_iterator<char>(file), {});
  text.replace(text.find("inner_ratio: 0.5"), 16, "inner_ratio: 0.05");
  std::ofstream(scene.file()) << text;
  launcher::check_command(scene.file(), 0.05, fitted);
  CHECK_THAT(fitted.str(), !Contains("calibrated"));
}

TEST_CASE("check: tells Poisson's ratio computed with, where it is not the one asked for") {
  // Oracle: analytic, κ = 100 μ is 298/602; asked for are the default 0.499, and 0.45.
  if (geometry::testing::without_gmsh()) return;
  const BallScene scene;
  std::ifstream file(scene.file());
  std::string text(std::istreambuf_iterator<char>(file), {});
  text.replace(text.find("springs: {inner_ratio: 0.5}"), 27, "model: nodal_pressure");
  const auto check_with = [&](const std::string& more) {
    std::ofstream(scene.file()) << std::string(text).insert(text.find("    tissue"), more);
    std::ostringstream out;
    launcher::check_command(scene.file(), 0.01, out);
    return out.str();
  };
  CHECK_THAT(check_with(""), Contains("Poisson's ratio 0.499, computed with 0.495\n"));
  CHECK_THAT(check_with("    solid: {poisson_ratio: 0.45}\n"), Contains("Poisson's ratio 0.45\n"));
}

TEST_CASE("check: a bad scene is refused with its place") {
  // Oracle: the message.
  const BallScene scene("topic: {start_m: [0, 0, 0.09]}", "wrong_key: 1\n");
  std::ostringstream out;
  CHECK_THROWS_WITH(launcher::check_command(scene.file(), 0.05, out),
                    Contains(scene.file().string() + ":12:") && Contains("wrong_key"));
  CHECK(out.str().empty());
}

TEST_CASE("check: a recording that cannot be used is refused by file and line, gaps are told") {
  // Oracle: what the haptics process says of the same file
  // (tests/haptics/trajectory_file_test.cpp).
  const BallScene scene("trajectory: {file: moves.csv}");
  const auto file = scene.folder() / "moves.csv";
  std::ostringstream out;
  std::ofstream(file) << "t,x,y,z\n0,0,0,0\n";
  CHECK_THROWS_WITH(launcher::check_command(scene.file(), 0.05, out), Contains("moves.csv:1: "));
  std::ofstream(file) << "t,x,y,z,qx,qy,qz,qw\n0,0,0,0.09,0,0,0,1\nnone,0,0,0.09,0,0,0,1\n"
                         "0.01,0,0,0.09,0,0,0,1\n";
  CHECK(launcher::check_command(scene.file(), 0.05, out) == kExitDone);
  CHECK_THAT(out.str(), Contains("warning: ") && Contains("moves.csv:3: "));
}
