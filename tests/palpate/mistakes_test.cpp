// What a new user gets wrong, as it is typed: each is named in a line that says what to do, and
// ends with exit code 2 or is a warning before the run.
#include <catch2/catch.hpp>
#include <fstream>

#include "modules/core/error.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "tests/palpate/ball_scene.h"
#include "tests/palpate/typed_command.h"

using namespace palpate;
using palpate::testing::BallScene;
using palpate::testing::type;

namespace {

constexpr const char* kNoTetrahedra =
    "no tetrahedra, which files of this kind are read as; convert a surface to .ply";

using Words = std::vector<std::string>;

struct Mistake {
  Words typed;
  std::string named;  ///< what the line must say
};

const std::string kPress =
    "scripted: {start_m: [0, 0, 0.09], moves: [{to_m: [0, 0, 0.05], duration_s: 1}]}";

/// A folder with a sound scene, and with files that are not.
class Desk {
 public:
  Desk() : scene_(kPress, "duration_s: 2\n") {
    const auto ball = geometry::make_ball(0.05, 2);
    auto large = ball, open = ball, two = ball;
    for (Vec3& node : large.nodes) node *= 1000;
    geometry::write_surface(large, file("in_mm.stl"));
    for (Vec3& node : large.nodes) node *= 1000;
    geometry::write_surface(large, file("huge.stl"));
    open.triangles.pop_back();
    geometry::write_surface(open, file("open.ply"));
    const auto count = static_cast<std::uint32_t>(ball.nodes.size());
    for (const Vec3& node : ball.nodes) two.nodes.push_back(0.2 * node);
    for (const auto& [a, b, c] : ball.triangles) {
      two.triangles.push_back({a + count, b + count, c + count});
    }
    geometry::write_surface(two, file("two.ply"));
    write("garbage.stl", "this is no mesh\n");
    const std::string nodes =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
        "$EndNodes\n$Elements\n1\n1 ";
    write("tetrahedra.msh", nodes + "4 2 0 1 1 2 3 4\n$EndElements\n");
    write("surface.msh", nodes + "2 2 0 1 1 2 3\n$EndElements\n");
    write("empty.yaml", "");
    write("untitled.yaml", "organs: []\n");
    write("quote.yaml", "palpate_scene: 1\nname: \"press\n");
    write("tab.yaml", "palpate_scene: 1\norgans:\n\t- name: a\n");
    write("twice.yaml", "palpate_scene: 1\nduration_s: 1\nduration_s: 2\n");
    write("notes.mcap", "no recording\n");
    write("old.mcap", "\x89MCAP0\r\n");
    moves("good.csv", 1, 1);
    moves("in_mm.csv", 1000, 1);
    moves("in_ms.csv", 1, 1000);
    write("header.csv", "time,x,y,z\n0,0,0,0\n");
  }

  std::string file(const std::string& name) const { return (scene_.folder() / name).string(); }
  std::string scene() const { return scene_.file().string(); }

  /// `palpate check` of the sound scene with one setting.
  Words with(const std::string& setting) const {
    return {"check", scene(), "--measure-s", "0.01", "--set", setting};
  }
  Words with(const std::string& setting, const std::string& other) const {
    Words typed = with(setting);
    typed.insert(typed.end(), {"--set", other});
    return typed;
  }

 private:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(scene_.folder() / name) << text;
  }
  void moves(const std::string& name, double length, double time) const {
    std::ofstream stream(scene_.folder() / name);
    stream << "t,x,y,z,qx,qy,qz,qw\n";
    for (int k = 0; k <= 200; ++k) {
      stream << time * 0.01 * k << ",0,0," << length * (0.09 - 0.0002 * k) << ",0,0,0,1\n";
    }
  }

  BallScene scene_;
};

std::vector<Mistake> mistakes(const Desk& desk) {
  const std::string scene = desk.scene();
  return {
      // what is typed
      {{"rum", scene}, "no command 'rum'"},
      {{"run", "nowhere.yaml", "--headless"}, "nowhere.yaml: no such file"},
      {{"run", desk.file("."), "--headless"}, "folder"},
      {{"run", scene, "--duration", "-1"}, "--duration"},
      {{"run", scene, "--duration", "abc"}, "--duration"},
      {{"run", scene, "--domain", "300"}, "--domain"},
      {{"run", scene, "--lockstep", "--set", "duration_s=0"}, "give --duration"},
      {{"run", scene, "--in-process", "--frames", "f"}, "--frames"},
      {{"run", scene, "--in-process", "--session", "s"}, "--session"},
      {{"run", scene, "--in-process", "--close"}, "--close"},
      {{"run", scene, "--in-process", "--no-restart"}, "--no-restart"},
      {{"run", scene, "--lockstep", "--no-restart"}, "--no-restart"},
      {{"run", scene, "--in-process", "--frame-interval-s", "1"}, "requires --frames"},
      {{"run", scene, "--lockstep", "--frame-interval-s", "1"}, "requires --frames"},
      {{"inspect", "a.mcap", "--overwrite"}, "requires --csv"},
      {{"run", scene, "--headless", "--only", "hapitcs"}, "hapitcs"},
      {{"run", scene, "--headless", "--record", scene}, "would be overwritten"},
      {{"run", scene, "--headless", "--record-topics", "all"}, "give --record FILE"},
      {{"run", scene, "--headless", "--overwrite"}, "give --record FILE"},
      {{"run", scene, "--headless", "--record", desk.file("old.mcap")}, "is there already"},
      {{"run", scene, "extra"}, "extra"},
      {{"run", scene, "--heedless"}, "--heedless"},
      {{"run", scene, "--in-process", "--secure", desk.file(".")}, "--secure"},
      {{"list", "everything"}, "everything"},
      {{"inspect", desk.file("notes.mcap")}, "notes.mcap"},
      {{"inspect", "nowhere.mcap"}, "nowhere.mcap"},
      {{"replay", "nowhere.mcap"}, "nowhere.mcap"},
      {{"diff", desk.file("notes.mcap")}, "B is required"},
      // meshes
      {{"mesh", "nowhere.stl"}, "nowhere.stl"},
      {{"mesh", desk.file("in_mm.stl"), "--unit", "feet"}, "feet"},
      {{"mesh", desk.file("in_mm.stl"), "--nodes", "2"}, "--nodes"},
      {{"mesh", desk.file("in_mm.stl"), "-o", desk.file("a.docx")}, "a.docx"},
      {{"mesh", desk.file("garbage.stl")}, "garbage.stl"},
      {{"mesh", desk.file("open.ply")}, "--fill-holes closes 1 hole"},
      {{"mesh", desk.file("two.ply")}, "--largest keeps the shell with"},
      {{"mesh", desk.file("tetrahedra.msh")}, "holds tetrahedra; `palpate mesh` prepares surfaces"},
      {{"new", desk.file("tetrahedra.msh")}, "A scene takes them as they are: organs: [{mesh: {"},
      {{"mesh", desk.file("surface.msh")}, kNoTetrahedra},
      {{"new", desk.file("surface.msh")}, kNoTetrahedra},
      {{"mesh", "nowhere.vtk"}, "nowhere.vtk: no such file"},
      {{"new", "nowhere.vtk"}, "nowhere.vtk: no such file"},
      {{"mesh", desk.file("in_mm.stl")}, "With --unit mm it would be 100 mm"},
      {{"new", desk.file("in_mm.stl"), "--unit", "m", "-o", desk.file("h.yaml")},
       "With --unit mm it would be 100 mm"},
      {{"mesh", desk.file("in_mm.stl"), "--near", desk.file("good.csv")}, "needs --radius-m"},
      {{"mesh", desk.file("in_mm.stl"), "--near", desk.file("good.csv"), "--radius-m", "8"},
       "--radius-m"},
      {{"new", desk.file("in_mm.stl"), "-o", scene}, "is there already"},
      {{"new", desk.file("huge.stl"), "-o", desk.file("h.yaml")}, "say --unit"},
      // scene files
      {{"check", desk.file("empty.yaml")}, "the scene is empty"},
      {{"check", desk.file("untitled.yaml")}, "the first key must be palpate_scene: 1"},
      {{"check", desk.file("quote.yaml")}, "a quoted text is not closed"},
      {{"check", desk.file("tab.yaml")}, "tab.yaml:3"},
      {{"check", desk.file("twice.yaml")}, "is given twice"},
      // keys and values
      {desk.with("rates.deformation"), "must be KEY=VALUE"},
      {desk.with("organs[0].tissue.youngs_modulus=8e3"), "did you mean 'youngs_modulus_pa'?"},
      {desk.with("organs[0].tisue.drag_per_s=1"), "did you mean 'tissue'?"},
      {desk.with("organs[3].model=mass_spring"), "organs[3]"},
      {desk.with("organs[0].tissue.youngs_modulus_pa=10"), "youngs_modulus_pa"},
      {desk.with("probes[0].shape.sphere.radius_m=8"), "radius_m"},
      {desk.with("probes[0].shape.sphere.radius_m=-0.01"), "radius_m"},
      {desk.with("duration_s=soon"), "'soon'"},
      {desk.with("organs[0].model=mass_springs"), "mass_springs"},
      {desk.with("organs[0].solid.poisson_ratio=0.4"), "is not read by model"},
      {desk.with("organs[0].mesh.file=nowhere.ply"), "nowhere.ply"},
      {desk.with("organs[0].mesh={file: surface.msh}"), kNoTetrahedra},
      {desk.with("organs[0].rotation_xyzw=[1, 1, 0, 0]"), "rotation_xyzw"},
      {desk.with("probes[0].shape={sphere: {radius_m: 0.01}, plane: {}}"), "exactly one of"},
      {desk.with("probes=[]"), "at least one entry"},
      {desk.with("organs[0].fixed=[{box: {min_m: [1, 1, 1], max_m: [0, 0, 0]}}]"), "below"},
      {desk.with("rates.haptics_hz=100"), "haptics_hz"},
      // what can be run, and should not
      {desk.with("organs[0].mesh={file: in_mm.stl}"), "With mesh: {unit: mm} it would be 100 mm"},
      {desk.with("organs[0].fixed=[{sphere: {center_m: [1, 0, 0], radius_m: 0.1}}]"),
       "fixed[0] holds no node"},
      {desk.with("organs[0].fixed=[]"), "nothing holds it"},
      {desk.with("organs[0].fixed=[{sphere: {center_m: [0, 0, 0], radius_m: 1}}]"),
       "nodes; leave some free to move"},
      {desk.with("probes[0].device={scripted: {start_m: [0, 0, 0], moves: [{wait_s: 1}]}}"),
       "begins inside an organ"},
      {desk.with("probes[0].device={scripted: {start_m: [0.3, 0, 0], moves: [{wait_s: 1}]}}"),
       "touches nothing"},
      {desk.with("probes[0].device={trajectory: {file: in_mm.csv}}"), "millimetres"},
      {desk.with("probes[0].device={trajectory: {file: in_ms.csv}}", "duration_s=0"),
       "milliseconds"},
      {desk.with("probes[0].device={trajectory: {file: header.csv}}"), "header.csv:1"}};
}

bool is_named(const std::string& said, const std::string& named) {
  return said.find(named) != std::string::npos;
}

}  // namespace

TEST_CASE("mistakes: each is named in a line, and refused or warned of before the run") {
  // Oracle: the list above; the exit codes of core/error.h.
  const Desk desk;
  const auto sound = type("palpate", {"check", desk.scene(), "--measure-s", "0.01"});
  CHECK(sound.code == kExitDone);
  const auto all = mistakes(desk);
  CHECK(all.size() >= 50);
  for (const auto& [typed, named] : all) {
    const auto outcome = type("palpate", typed);
    CAPTURE(typed, named, outcome.said);
    const bool warned = outcome.code == kExitDone && is_named(outcome.said, "warning: ");
    CHECK((outcome.code == kExitBadInput || warned));
    CHECK(is_named(outcome.said, named));
    CHECK_FALSE(is_named(sound.said, named));
  }
}

TEST_CASE("mistakes: a program that was not built is named with the target that builds it") {
  // Oracle: a folder that holds `palpate` alone.
  const BallScene scene;
  std::filesystem::copy(std::filesystem::path(PALPATE_BIN_DIR) / "palpate",
                        scene.folder() / "palpate");
  launcher::ChildProcess alone(scene.folder() / "palpate", {"plan", scene.file().string()});
  REQUIRE(palpate::testing::wait_until([&] { return alone.ended().has_value(); }));
  std::string said;
  for (const auto& line : alone.take_lines()) said += line;
  CHECK_THAT(said, Catch::Contains("--target palpate-plan"));
}
