#include "palpate/mesh_command.h"

#include "modules/core/error.h"
#include "modules/geometry/mesh_check.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

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
  CHECK_THAT(outcome.out, Contains("inside out turned outward: 1"));
  CHECK(check_surface(read_surface(folder / "out.off", "m")).holds_volume());
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
  CHECK(run({folder / "in.ply", folder / "no" / "out.ply", 0, "m"}).code == kExitFailed);
}
