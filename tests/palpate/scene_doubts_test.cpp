#include "palpate/scene_doubts.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/settings.h"
#include "tests/palpate/ball_scene.h"

using namespace palpate;
using namespace palpate::launcher;
using Catch::Contains;
using palpate::testing::BallScene;

namespace {

std::string scripted(const std::string& start, const std::string& moves) {
  return "scripted: {start_m: " + start + ", moves: [" + moves + "]}";
}

const std::string kDownOnBall = scripted("[0, 0, 0.09]", "{to_m: [0, 0, 0.05], duration_s: 2}");

std::vector<std::string> doubts(const BallScene& scene,
                                const std::vector<std::string>& settings = {}) {
  const auto loaded = scene::load_scene_with(scene.file(), settings);
  return doubts_about(loaded, load_skins(loaded)).lines;
}

/// The one doubt there is.
std::string doubt(const BallScene& scene, const std::vector<std::string>& settings = {}) {
  const auto all = doubts(scene, settings);
  CAPTURE(all);
  CHECK(all.size() == 1);
  return all.empty() ? "" : all[0];
}

}  // namespace

TEST_CASE("doubts: a press of a ball on its foot leaves none, and touches when it must") {
  // Oracle: the minimum-jerk curve: half of 40 mm at half of 2 s; the sphere of 10 mm touches the
  // ball of 50 mm at a height of 60 mm, after 30 of 40 mm.
  const BallScene scene(kDownOnBall, "duration_s: 4\n");
  CHECK(doubts(scene).empty());
  const auto loaded = scene::load_scene(scene.file());
  std::vector<std::string> warnings;
  const collision::Approach approach = motion_of(loaded, 0, load_skins(loaded), warnings).approach;
  REQUIRE(approach.touches_at);
  // s(u) = 10u³ − 15u⁴ + 6u⁵ = 0.75 at u = 0.6409; facets of 5 mm are up to 0.06 mm inside.
  CHECK(*approach.touches_at == Approx(2 * 0.6409).margin(0.02));
  CHECK(approach.fastest == Approx(0.04 / 2 * 1.875).epsilon(1e-3));
  CHECK(approach.extent == Approx(0.04));
  CHECK_FALSE(approach.begins_inside);
  CHECK(warnings.empty());
}

TEST_CASE("doubts: laws that come more seldom than forces begin to fade are told of") {
  // Oracle: the periods, 50 ms at 20 Hz and 40 at 25, beside 50 ms of stale_after_s.
  const BallScene scene(kDownOnBall, "duration_s: 4\n");
  CHECK_THAT(doubt(scene, {"rates.deformation_hz=20"}),
             Contains("rates.deformation_hz is 20: a force is told every 50 ms") &&
                 Contains("stale_after_s, 50 ms, it fades"));
  CHECK(doubts(scene, {"rates.deformation_hz=25"}).empty());
  CHECK(doubts(scene, {"rates.deformation_hz=20", "haptics.stale_after_s=0.1"}).empty());
}

TEST_CASE("doubts: an organ in another unit is refused, and the likely unit named") {
  // Oracle: the ball of 100 mm, read as if its file were in other units.
  const BallScene scene(kDownOnBall, "duration_s: 4\n");
  CHECK_THROWS_WITH(doubts(scene, {"organs[0].mesh.unit=um"}),
                    Contains("organ 'ball' is 0.1 um long, read in um") && Contains("unit: m"));
  auto ball = geometry::read_surface(scene.folder() / "ball.ply", "m");
  for (Vec3& node : ball.nodes) node *= 1000;
  geometry::write_surface(ball, scene.folder() / "ball.ply");
  CHECK_THROWS_WITH(doubts(scene), Contains("organ 'ball' is 100 m long, read in m; between 2 mm "
                                            "and 2 m are allowed") &&
                                       Contains("With mesh: {unit: mm} it would be 100 mm"));
}

TEST_CASE("doubts: what lets an organ fly or keeps it from moving is named") {
  // Oracle: the regions, written so that they hold none, or all, of its nodes.
  const BallScene scene(kDownOnBall, "duration_s: 4\n");
  CHECK_THAT(doubt(scene, {"organs[0].fixed=[]"}), Contains("nothing holds it"));
  CHECK_THAT(doubt(scene, {"organs[0].fixed=[{sphere: {center_m: [1, 0, 0], radius_m: 0.1}}]"}),
             Contains("fixed[0] holds no node"));
  CHECK_THAT(doubt(scene, {"organs[0].fixed=[{sphere: {center_m: [0, 0, 0], radius_m: 1}}]"}),
             Contains("all of its surface is fixed"));
}

TEST_CASE("doubts: a probe that a following mesh does not follow is named") {
  // Oracle: decision 15.
  const auto said = [](const std::vector<std::string>& settings) {
    const auto scene =
        scene::load_scene_with(data_folder() / "scenes" / "liver_touch.yaml", settings);
    return std::ranges::count_if(doubts_about(scene, load_skins(scene)).lines,
                                 [](const std::string& line) {
                                   return line.find(
                                              "is a plane, under which organ 'liver' does "
                                              "not refine") != std::string::npos;
                                 });
  };
  CHECK(said({}) == 0);
  CHECK(said({"probes[0].shape={plane: {}}"}) == 1);
}

TEST_CASE("doubts: a tool of so fine a mesh that searches take longer than real time is named") {
  // Oracle: the number of nodes of both, 642 of the ball and 642 or 2,562 of the tool.
  const BallScene scene(kDownOnBall, "duration_s: 4\n");
  const auto with_tool = [&](int halvings) {
    geometry::write_surface(geometry::make_ball(0.01, halvings), scene.folder() / "tool.ply");
    return std::vector<std::string>{
        "probes[0].shape={mesh: {file: " + (scene.folder() / "tool.ply").string() + "}}"};
  };
  CHECK(doubts(scene, with_tool(3)).empty());
  CHECK_THAT(doubt(scene, with_tool(4)), Contains("probe 'finger' has a mesh of 2562 nodes"));
}

TEST_CASE("doubts: a probe that begins inside, or never touches, is named") {
  // Oracle: where the ball and the moves are.
  CHECK_THAT(doubt(BallScene(scripted("[0, 0, 0]", "{wait_s: 1}"), "duration_s: 1\n")),
             Contains("begins inside an organ"));
  const std::string missed = doubt(BallScene(
      scripted("[0.2, 0, 0.09]", "{to_m: [0.2, 0, 0.05], duration_s: 2}"), "duration_s: 4\n"));
  CHECK_THAT(missed, Contains("touches nothing in the first 4 s") && Contains("15"));
  // A hand may do what it likes.
  CHECK(doubts(BallScene("mouse: {start_m: [0.3, 0, 0]}", "duration_s: 1\n")).empty());
}

TEST_CASE("doubts: a recording in millimetres, and one in milliseconds, are recognised") {
  // Oracle: a press in metres and seconds, its columns multiplied by 1000.
  const BallScene scene("trajectory: {file: moves.csv}", "duration_s: 4\n");
  const auto write = [&](double length, double time) {
    std::ofstream file(scene.folder() / "moves.csv");
    file << "t,x,y,z,qx,qy,qz,qw\n";
    for (int k = 0; k <= 200; ++k) {
      file << time * 0.01 * k << ",0,0," << length * (0.09 - 0.0002 * k) << ",0,0,0,1\n";
    }
  };
  write(1, 1);
  CHECK(doubts(scene).empty());
  write(1000, 1);
  const auto far = doubts(scene);
  CHECK(std::any_of(far.begin(), far.end(), [](const std::string& line) {
    return line.find("length_unit: mm") != std::string::npos;
  }));
  write(1, 1000);
  const auto slow = doubts(scene, {"duration_s=0"});
  CHECK(std::any_of(slow.begin(), slow.end(), [](const std::string& line) {
    return line.find("time_unit: ms") != std::string::npos;
  }));
}
