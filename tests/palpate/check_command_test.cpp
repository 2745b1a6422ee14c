#include "palpate/check_command.h"

#include <json/json.h>

#include <algorithm>
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
using palpate::testing::BallScene;

namespace {

/// What `palpate check` prints of the scene.
std::string check(const BallScene& scene, double measure_for = 0.05) {
  std::ostringstream out;
  CHECK(launcher::check_command({.scene = scene.file(), .measure_for = measure_for}, out, out) ==
        kExitDone);
  return out.str();
}

}  // namespace

TEST_CASE("check: --resolved prints the scene with every default, which can be read back") {
  // Oracle: the scene reader.
  const BallScene scene;
  std::ostringstream out;
  CHECK(launcher::check_command({.scene = scene.file(), .resolved = true}, out, out) == kExitDone);
  const auto loaded = scene::load_scene(scene.file());
  CHECK(scene::scene_digest(scene::parse_scene(out.str(), scene.file())) ==
        scene::scene_digest(loaded));
}

TEST_CASE("check: the verdict comes first, and all of it is at most ten lines") {
  // Oracle: the text's lines.
  const std::string text = check(BallScene());
  CHECK_THAT(text.substr(0, text.find('\n')),
             Contains("press.yaml: can be run, with 1 doubt; ") && Contains("real time here"));
  CHECK(std::count(text.begin(), text.end(), '\n') <= 10);
}

TEST_CASE("check: --json says the same as the text") {
  // Oracle: counts of the ball, read by the JSON library.
  const BallScene scene;
  std::ostringstream out;
  CHECK(launcher::check_command({.scene = scene.file(), .measure_for = 0.05, .json = true}, out,
                                out) == kExitDone);
  Json::Value value;
  std::istringstream text(out.str());
  REQUIRE(Json::parseFromStream(Json::CharReaderBuilder(), text, &value, nullptr));
  CHECK(value["organs"][0]["surface_nodes"] == 642);
  CHECK(value["organs"][0]["triangles"] == 1280);
  CHECK(value["probes"][0]["device"] == "mouse");
  CHECK(value["warnings"].size() == 1);
  CHECK(value["deformation_period_s"] == 0.004);
}

TEST_CASE("check: --set is checked like the file") {
  // Oracle: the mass of the same ball at another density.
  const BallScene scene;
  std::ostringstream out;
  launcher::CheckOptions options{.scene = scene.file(), .measure_for = 0.05, .json = true};
  options.settings = {"organs[0].tissue.density_kg_per_m3=500"};
  CHECK(launcher::check_command(options, out, out) == kExitDone);
  Json::Value value;
  std::istringstream text(out.str());
  REQUIRE(Json::parseFromStream(Json::CharReaderBuilder(), text, &value, nullptr));
  const auto& organ = value["organs"][0];
  CHECK(organ["mass_kg"].asDouble() == Approx(500 * organ["volume_m3"].asDouble()));
}

TEST_CASE("check: counts, volume and mass are those of the mesh") {
  // Oracle: Euler's formula (E = 3N − 6, F = 2N − 4) and the enclosed volume of the file.
  const BallScene scene;
  const std::string text = check(scene);
  const auto ball = geometry::read_surface(scene.folder() / "ball.ply", "m");
  const double volume = geometry::enclosed_volume(ball.nodes, ball.triangles);
  char measures[80];
  std::snprintf(measures, sizeof measures, "%.1f cm3, %.3f kg", 1e6 * volume, 1058 * volume);
  CHECK_THAT(text, Contains("organ ball: 100 x 100 x 100 mm, ") &&
                       Contains("642 surface + 6 virtual nodes") && Contains("1280 triangles") &&
                       Contains("1920 structural") && Contains(measures));
}

TEST_CASE("check: tells sub-steps, rates, cost and the real-time factor to expect") {
  // Oracle: definition.
  const BallScene scene;
  const std::string text = check(scene);
  CHECK_THAT(text, Contains("sub-steps of") && Contains("(largest ") &&
                       Contains("rates: haptics 1000 Hz, collision 250 Hz") &&
                       Contains("deformation takes ") && Contains("real-time factor "));
}

TEST_CASE("check: says which integrator steps the springs, who chose it and by what") {
  // Oracle: the rule. A ball of 642 nodes at 10 kPa is cheap to step explicitly.
  const BallScene scene;
  const std::string text = check(scene);
  CHECK_THAT(text, Contains("symplectic_euler (automatic), passes over the springs "
                            "per simulated second: symplectic_euler ") &&
                       Contains("backward_euler 3500\n"));
}

TEST_CASE("check: springs that are not the fitted ones are named") {
  // Oracle: docs/calibration.md. The ball's inner_ratio of 0.5 is ten times the fitted one.
  const BallScene scene;
  const std::string text = check(scene);
  CHECK_THAT(text, Contains("warning: organ 'ball': inner_ratio 0.5 is not calibrated"));
  std::ifstream file(scene.file());
  std::string fitted(std::istreambuf_iterator<char>(file), {});
  fitted.replace(fitted.find("inner_ratio: 0.5"), 16, "inner_ratio: 0.05");
  std::ofstream(scene.file()) << fitted;
  CHECK_THAT(check(scene), !Contains("calibrated"));
}

TEST_CASE("check: contacts of organs that a scene has not two of are named") {
  // Oracle: what the switch is for.
  const BallScene scene;
  std::ofstream(scene.file(), std::ios::app) << "\ncontacts: {organs: true}\n";
  CHECK_THAT(check(scene), Contains("warning: contacts: organs: true changes nothing"));
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
    return check(scene, 0.01);
  };
  CHECK_THAT(check_with(""), Contains("Poisson's ratio 0.499, computed with 0.495\n"));
  CHECK_THAT(check_with("    solid: {poisson_ratio: 0.45}\n"), Contains("Poisson's ratio 0.45\n"));
}

TEST_CASE("check: a bad scene is refused with its place") {
  // Oracle: the message.
  const BallScene scene("topic: {start_m: [0, 0, 0.09]}", "wrong_key: 1\n");
  std::ostringstream out;
  CHECK_THROWS_WITH(launcher::check_command({.scene = scene.file(), .measure_for = 0.05}, out, out),
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
  CHECK_THROWS_WITH(launcher::check_command({.scene = scene.file(), .measure_for = 0.05}, out, out),
                    Contains("moves.csv:1: "));
  std::ofstream(file) << "t,x,y,z,qx,qy,qz,qw\n0,0,0,0.09,0,0,0,1\nnone,0,0,0.09,0,0,0,1\n"
                         "0.01,0,0,0.09,0,0,0,1\n";
  CHECK(launcher::check_command({.scene = scene.file(), .measure_for = 0.05}, out, out) ==
        kExitDone);
  CHECK_THAT(out.str(), Contains("warning: ") && Contains("moves.csv:3: "));
}
