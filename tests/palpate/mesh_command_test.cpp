#include "palpate/mesh_command.h"

#include <json/json.h>

#include <csignal>
#include <sstream>

#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/geometry/gmsh_file.h"
#include "modules/geometry/mesh_check.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "modules/scene/assets.h"
#include "tests/modules/geometry/scratch.h"
#include "tests/modules/geometry/tetrahedra.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;
using Catch::Contains;

namespace {

struct Outcome {
  int code = 0;
  std::string out, err;
};

Outcome run(const MeshCommandOptions& options) {
  std::ostringstream out, err;
  const int code = run_mesh_command(options, out, err);
  return {code, out.str(), err.str()};
}

}  // namespace

TEST_CASE("mesh command: decimates, reports and writes in metres") {
  // Oracle: the written file, read back: 5 cm ball given in millimetres.
  const ScratchFolder folder;
  write_surface(make_ball(50, 3), folder / "in.stl");
  const Outcome outcome = run({folder / "in.stl", folder / "out.ply", 100, "mm"});
  CHECK(outcome.code == kExitDone);
  CHECK(outcome.err.empty());
  CHECK_THAT(outcome.out, Contains("642, 1280") && Contains("100, 196") && Contains("519.1 cm³") &&
                              Contains("none needed") && Contains("written: "));
  CHECK(std::count(outcome.out.begin(), outcome.out.end(), '\n') <= 30);  // one screen
  const MeshReport report = check_surface(read_surface(folder / "out.ply", "m"));
  CHECK(report.node_count == 100);
  CHECK(report.holds_volume());
  CHECK(report.volume == Approx(519.1e-6).epsilon(1e-3));
}

TEST_CASE("mesh command: without an output it only checks") {
  // Oracle: the contract: no file appears.
  const ScratchFolder folder;
  write_surface(make_ball(0.05, 2), folder / "in.ply");
  const Outcome outcome = run({folder / "in.ply", {}, 0, "m"});
  CHECK(outcome.code == kExitDone);
  CHECK(folder.file_count() == 1);
  CHECK_THAT(outcome.out, Contains("closed (open edges)     ok") && !Contains("WRONG"));
}

TEST_CASE("mesh command: repairs are told") {
  // Oracle: an inside-out file.
  const ScratchFolder folder;
  write_surface(inside_out(make_ball(0.05, 2)), folder / "in.obj");
  const Outcome outcome = run({folder / "in.obj", folder / "out.off", 0, "m"});
  CHECK(outcome.code == kExitDone);
  CHECK_THAT(outcome.out, Contains("inside out turned outward: 1") && !Contains("repaired"));
  CHECK(check_surface(read_surface(folder / "out.off", "m")).holds_volume());
}

TEST_CASE("mesh command: what repairs leave is measured again") {
  // Oracle: a node that no triangle uses goes: 162 of 163 stay.
  const ScratchFolder folder;
  TriangleSurface ball = make_ball(0.05, 2);
  ball.nodes.push_back(Vec3::Zero());
  write_surface(ball, folder / "in.ply");
  const std::string said = run({folder / "in.ply", {}, 0, "m"}).out;
  CHECK(said.find("163, 320") < said.find("repairs\n"));
  CHECK_THAT(said, Contains("repaired\n  nodes, triangles        162, 320\n"));
}

TEST_CASE("mesh command: a leaking mesh is not written, and what, where and the remedy are told") {
  // Oracle: the contract: exit code 2 and no file.
  const ScratchFolder folder;
  TriangleSurface open = make_ball(0.05, 2);
  open.triangles.pop_back();
  write_surface(open, folder / "in.ply");
  const Outcome outcome = run({folder / "in.ply", folder / "out.ply", 0, "m"});
  CHECK(outcome.code == kExitBadInput);
  CHECK(folder.file_count() == 1);
  CHECK_THAT(outcome.out,
             Contains("closed (open edges)     WRONG: 3") && Contains("leak test    WRONG"));
  CHECK_THAT(outcome.err, Contains("in.ply: cannot hold a volume; nothing written") &&
                              Contains("3 open edges, the first: nodes") &&
                              Contains("fill its holes"));
}

TEST_CASE("mesh command: every bad option is exit code 2, a failed write exit code 1") {
  // Oracle: the exit codes of the contract.
  const ScratchFolder folder;
  write_surface(make_ball(0.05, 2), folder / "in.ply");
  CHECK(run({folder / "none.ply", {}, 0, "m"}).code == kExitBadInput);
  const Outcome unit = run({folder / "in.ply", {}, 0, "ell"});
  CHECK(unit.code == kExitBadInput);
  CHECK_THAT(unit.err, Contains("unit 'ell'"));
  const Outcome count = run({folder / "in.ply", {}, 2, "m"});
  CHECK(count.code == kExitBadInput);
  CHECK_THAT(count.err, Contains("in.ply: cannot resample to 2 nodes"));
  const Outcome format = run({folder / "in.ply", folder / "out.doc", 0, "m"});
  CHECK(format.code == kExitBadInput);
  CHECK_THAT(format.err, Contains("allowed: .ply"));
  CHECK(format.out.empty());  // before any work
  const Outcome place = run({folder / "in.ply", folder / "no" / "out.ply", 0, "m"});
  CHECK(place.code == kExitBadInput);
  CHECK_THAT(place.err, Contains("out.ply: cannot be written: there is no folder "));
  CHECK(place.out.empty());
}

TEST_CASE("mesh command: a file that is there is replaced only if that is asked for") {
  // Oracle: the file's bytes, the message.
  const ScratchFolder folder;
  write_surface(make_ball(0.05, 2), folder / "in.ply");
  MeshCommandOptions options{folder / "in.ply", folder.write("out.ply", "mine")};
  const Outcome kept = run(options);
  CHECK(kept.code == kExitBadInput);
  CHECK_THAT(kept.err, Contains("out.ply: is there already; give another name, or --overwrite"));
  CHECK(text_in(options.output) == "mine");
  options.overwrite = true;
  CHECK(run(options).code == kExitDone);
  CHECK(text_in(options.output) != "mine");
}

namespace {

/// A block of 60 mm, edges of 15 to 26 mm, and a motion down onto the middle of its top, in
/// millimetres: a sphere of 8 mm ends 4 mm deep.
struct BlockAndMotion {
  BlockAndMotion() {
    write_tetrahedra(palpate::geometry::testing::block(Vec3::Constant(0.06), 4, 4, 4),
                     folder / "in.msh");
    folder.write("way.csv", "s px py pz\n0 30 30 90\n1 30 30 64\n2 30 30 90\n");
  }
  MeshCommandOptions near(double radius) const {
    MeshCommandOptions options{folder / "in.msh", folder / "out.msh"};
    options.near.file = folder / "way.csv";
    options.near.columns = {"s", "px", "py", "pz"};
    options.near.unit = "mm";
    options.near.radius = radius;
    options.overwrite = true;
    return options;
  }
  ScratchFolder folder;
};

}  // namespace

TEST_CASE("mesh command: near a motion tetrahedra are small, as those of a scene that says where") {
  // Oracle: the sizes by hand, edges of R/2 within R of the touched place and 0.5 longer per
  // distance, those far off unhalved; the scene's key, which makes the same mesh bit by bit.
  const BlockAndMotion given;
  MeshCommandOptions options = given.near(8e-3);
  const Outcome outcome = run(options);
  INFO(outcome.out << outcome.err);
  REQUIRE(outcome.code == kExitDone);
  CHECK_THAT(outcome.out, Contains("touched                 1 places, each within 8 mm") &&
                              Contains("at most 4 mm") && Contains("mesh: {file: out.msh}"));
  const TetMesh mesh = read_gmsh(given.folder / "out.msh");
  CHECK(palpate::geometry::testing::volume_of(mesh) == Approx(216e-6));
  const Vec3 place(0.03, 0.03, 0.06);
  double longest = 0;
  for (const auto& corners : mesh.tetrahedra) {
    for (const auto& [i, k] : kTetrahedronEdges) {
      const Vec3 a = mesh.nodes[corners[i]], b = mesh.nodes[corners[k]];
      const double away = ((a + b) / 2 - place).norm();
      CHECK((a - b).norm() <= 4e-3 + 0.5 * std::max(0.0, away - 8e-3) + 1e-12);
      longest = std::max(longest, (a - b).norm());
    }
  }
  CHECK(longest > 15e-3);

  scene::Organ organ;
  organ.mesh.file = given.folder / "in.msh";
  organ.model = "nodal_pressure";
  organ.solid.refine = {{scene::SphereRegion{place, 8e-3}}, 4e-3, 0.5};
  const auto keyed = scene::load_organ(organ);
  organ.mesh.file = given.folder / "out.msh";
  organ.solid.refine = {};
  const auto made = scene::load_organ(organ);
  CHECK(made.surface.nodes == keyed.surface.nodes);
  CHECK(made.inner_nodes == keyed.inner_nodes);
  CHECK(made.tetrahedra == keyed.tetrahedra);

  // The same way, recorded in another frame: a quarter turn about x, then 1 m off.
  given.folder.write("way.csv", "s px py pz\n0 30 90 -30\n1 30 64 -30\n2 30 90 -30\n");
  options.near.position = {1, 0, 0};
  options.near.rotation = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  CHECK_THAT(run(options).err, Contains("touches nothing"));
  options.near.position = {0, 0, 0};
  REQUIRE(run(options).code == kExitDone);
  CHECK(read_gmsh(given.folder / "out.msh").nodes.size() == mesh.nodes.size());

  options.near.edge = 6e-3;
  options.near.growth = 1;
  options.json = true;
  Json::Value json;
  std::istringstream(run(options).out) >> json;
  CHECK(json["near"]["edge_m"].asDouble() == 6e-3);
  CHECK(json["near"]["nodes"].asUInt64() < mesh.nodes.size());
}

TEST_CASE("mesh command: a surface near a motion is filled first") {
  // Oracle: the organ's surface as it was, its nodes first, and a mesh that a scene reads.
  if (palpate::geometry::testing::without_gmsh()) return;
  const ScratchFolder folder;
  const TriangleSurface ball = make_ball(0.05, 2);
  write_surface(ball, folder / "in.ply");
  folder.write(
      "way.csv",
      "t,x,y,z,qx,qy,qz,qw\n0,0,0,0.07,0,0,0,1\n1,0,0,0.055,0,0,0,1\n2,0.02,0,0.055,0,0,0,1\n");
  MeshCommandOptions options{folder / "in.ply", folder / "out.msh"};
  options.near.file = folder / "way.csv";
  options.near.radius = 0.01;
  const Outcome outcome = run(options);
  INFO(outcome.out << outcome.err);
  REQUIRE(outcome.code == kExitDone);
  const TetMesh mesh = read_gmsh(folder / "out.msh");
  REQUIRE(mesh.nodes.size() > ball.nodes.size());
  for (std::size_t i = 0; i < ball.nodes.size(); ++i) {
    CHECK((mesh.nodes[i] - ball.nodes[i]).norm() < 1e-8);  // a file of single precision
  }
  CHECK(palpate::geometry::testing::volume_of(mesh) == Approx(volume_of(ball)).epsilon(1e-5));
}

TEST_CASE("mesh command: one that is stopped while a surface is filled writes nothing") {
  // Oracle: the contract: exit code 130, no file. The signal has come when Gmsh begins.
  const ScratchFolder folder;
  write_surface(make_ball(0.05, 2), folder / "in.ply");
  folder.write("way.csv", "t,x,y,z,qx,qy,qz,qw\n0,0,0,0.07,0,0,0,1\n1,0,0,0.055,0,0,0,1\n");
  MeshCommandOptions options{folder / "in.ply", folder / "out.msh"};
  options.near.file = folder / "way.csv";
  options.near.radius = 0.01;
  const StopSignal stop;
  std::raise(SIGTERM);
  const Outcome outcome = run(options);
  INFO(outcome.out << outcome.err);
  CHECK(outcome.code == kExitStopped);
  CHECK_THAT(outcome.err, Contains("stopped while Gmsh made tetrahedra"));
  CHECK_FALSE(std::filesystem::exists(folder / "out.msh"));
}

TEST_CASE("mesh command: what cannot be refined near a motion is told, and nothing written") {
  // Oracle: the contract: exit code 2, one line, no file.
  const BlockAndMotion given;
  const auto refused = [&](const MeshCommandOptions& options) {
    const Outcome outcome = run(options);
    CHECK(outcome.code == kExitBadInput);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    CHECK_FALSE(std::filesystem::exists(given.folder / "out.msh"));
    return outcome.err;
  };
  MeshCommandOptions options = given.near(8e-3);
  options.near.position = {0, 1};
  CHECK_THAT(refused(options), Contains("--near-position-m must be x, y, z"));
  options = given.near(8e-3);
  options.near.unit = "m";
  CHECK_THAT(refused(options), Contains("way.csv: a sphere of 8 mm touches nothing") &&
                                   Contains("read in m") && Contains("--near-unit"));
  options = given.near(8e-3);
  options.near.radius.reset();
  CHECK_THAT(refused(options), Contains("--near needs --radius-m"));
  options = given.near(8e-3);
  options.near.rotation = {0, 0, 0, 2};
  CHECK_THAT(refused(options), Contains("--near-rotation-xyzw must be a unit quaternion"));
  options = given.near(8e-3);
  options.near.columns = {"s"};
  CHECK_THAT(refused(options), Contains("--near-columns must name four"));
  options = given.near(8e-3);
  options.near.edge = 2e-4;
  CHECK_THAT(refused(options),
             Contains("--edge-m 0.0002, --growth 0.5, 125 nodes before: refined, it would "
                      "have more than 50000 nodes; allow longer edges"));
  options = given.near(8e-3);
  TetMesh apart = palpate::geometry::testing::block(Vec3::Constant(0.06), 1, 1, 1);
  for (const Vec3& node : std::vector(apart.nodes)) apart.nodes.push_back(node + Vec3(1, 0, 0));
  for (auto corners : std::vector(apart.tetrahedra)) {
    for (auto& node : corners) node += 8;
    apart.tetrahedra.push_back(corners);
  }
  options.input = given.folder / "apart.msh";
  write_tetrahedra(apart, options.input);
  CHECK_THAT(refused(options), Contains("apart.msh: "));
  options = given.near(8e-3);
  options.node_count = 300;
  CHECK_THAT(refused(options), Contains("--nodes, --largest and --fill-holes are of surfaces"));
  options = given.near(8e-3);
  options.output = given.folder / "out.ply";
  CHECK_THAT(refused(options), Contains("allowed: .msh"));
  options = given.near(8e-3);
  options.near.file = given.folder / "none.csv";
  CHECK_THAT(refused(options), Contains("none.csv"));
}

TEST_CASE("mesh command: what is said of a motion names the options here, not keys of a scene") {
  // Oracle: the texts by hand.
  const BlockAndMotion given;
  const std::string options_here =
      "(keys of a scene; here --near-columns T,X,Y,Z, --near-unit, --near-topic)";
  MeshCommandOptions options = given.near(8e-3);
  options.near.columns.clear();
  CHECK_THAT(run(options).err, Contains("header is 's,px,py,pz'") && Contains(options_here));
  options = given.near(8e-3);
  given.folder.write("way.csv", "s px py pz\n0 30 30 90\n0.001 30 30 64\n2 30 30 90\n");
  CHECK_THAT(run(options).out, Contains("which no hand is") && Contains(options_here));
  // The way does not depend on times: rare poses are no gaps here.
  std::string rare = "s px py pz\n";
  for (int i = 0; i < 30; ++i) {
    rare += std::to_string(20 * i) + " 30 30 " + std::to_string(90 - i) + "\n";
  }
  given.folder.write("way.csv", rare);
  CHECK_THAT(run(options).out, !Contains("gap") && !Contains("time_unit") && Contains("touched"));
  // Metres read as millimetres move hardly, and touch where they begin.
  given.folder.write("way.csv", "s px py pz\n0 0.030 0.030 0.090\n1 0.030 0.030 0.064\n");
  options.near.position = {0.03, 0.03, 0.06};
  CHECK_THAT(run(options).out, Contains("way.csv moves over 0.026 mm in all, read in mm: are its "
                                        "positions in metres? Then leave out --near-unit"));
}

TEST_CASE("mesh command: what is wrong with a motion is told before a surface is filled") {
  // Oracle: nothing of the surface has been said yet.
  const ScratchFolder folder;
  write_surface(make_ball(0.05, 2), folder / "in.ply");
  MeshCommandOptions options{folder / "in.ply", {}};
  options.near.radius = 8e-3;
  options.near.file = folder.write("way.csv", "t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n");
  options.near.unit = "feet";
  for (const bool is_there : {true, false}) {
    if (!is_there) {
      options.near.file = folder / "none.csv";
      options.near.unit = "m";
    }
    const Outcome outcome = run(options);
    CHECK(outcome.code == kExitBadInput);
    CHECK_THAT(outcome.err, Contains(is_there ? "feet" : "none.csv"));
    CHECK(outcome.out.empty());
  }
}

TEST_CASE("mesh command: a motion whose millimetres were read as metres is doubted") {
  // Oracle: the text; the motion, 40 mm long, 40 m as read, ends at the block, which it touches.
  const BlockAndMotion given;
  MeshCommandOptions options = given.near(8e-3);
  options.near.file = given.folder.write(
      "far.csv", "t,x,y,z,qx,qy,qz,qw\n0,0.03,0.03,40.06,0,0,0,1\n1,0.03,0.03,0.06,0,0,0,1\n");
  options.near.columns.clear();
  options.near.unit = "m";
  const Outcome outcome = run(options);
  CHECK(outcome.code == kExitDone);
  CHECK_THAT(outcome.out, Contains("moves over 40 m: are its positions in millimetres? Then say "
                                   "--near-unit mm"));
}
