#include "modules/geometry/mesh_prepare.h"

#include "modules/core/error.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;
using Catch::Contains;

TEST_CASE("load: a damaged file in millimetres becomes a sound organ in metres") {
  // Oracle: the volume of the ball that was written; single precision of the file.
  const ScratchFolder folder;
  const TriangleSurface ball = make_ball(50, 2);
  write_surface(inside_out(ball), folder / "ball.stl");
  const TriangleSurface organ = load_organ_surface(folder / "ball.stl", "mm", 0);
  const MeshReport report = check_surface(organ);
  CHECK(report.holds_volume());
  CHECK(report.node_count == ball.nodes.size());
  CHECK(report.volume == Approx(1e-9 * enclosed_volume(ball.nodes, ball.triangles)).epsilon(1e-6));
}

TEST_CASE("load: the node count is reached") {
  // Oracle: the contract.
  const ScratchFolder folder;
  write_surface(make_ball(0.05, 3), folder / "ball.ply");
  CHECK(load_organ_surface(folder / "ball.ply", "m", 100).nodes.size() == 100);
}

TEST_CASE("load: what cannot hold a volume is refused with file, problem and remedy") {
  // Oracle: the rules of load_organ_surface.
  const ScratchFolder folder;
  TriangleSurface open = make_ball(0.05, 2);
  open.triangles.pop_back();
  write_surface(open, folder / "open.ply");
  write_surface(both(make_ball(1, 1), moved(make_ball(1, 1), {5, 0, 0})), folder / "two.ply");
  const auto refusal = [&](const char* name, std::size_t nodes) {
    return message_of<InputError>([&] { load_organ_surface(folder / name, "m", nodes); });
  };
  CHECK_THAT(refusal("open.ply", 0), Contains("open.ply: cannot hold a volume") &&
                                         Contains("3 open edges") && Contains("fill its holes"));
  CHECK_THAT(refusal("open.ply", 100),
             Contains("open.ply: cannot resample to 100 nodes") && Contains("3 open edges"));
  CHECK_THAT(refusal("two.ply", 0), Contains("2 separate shells"));
  CHECK_THAT(refusal("none.ply", 0), Contains("none.ply: no such file"));
}

TEST_CASE("load: an OFF file with an index out of range is refused") {
  // Oracle: the message by hand, with the line of the face that names a sixth vertex of five.
  const ScratchFolder folder;
  const auto file = folder.write("index.off",
                                 "OFF\n5 6 0\n0 0 1\n1 0 0\n0 1 0\n-1 -1 0\n0 0 -1\n3 0 1 2\n"
                                 "3 0 2 3\n3 0 3 1\n3 4 2 1\n3 4 3 2\n3 4 9 3\n");
  const auto message = message_of<InputError>([&] { load_organ_surface(file, "m", 0); });
  CHECK_THAT(message, Contains("index.off:13: face 5 of 6 names vertex 9; allowed: 0 to 4"));
}
