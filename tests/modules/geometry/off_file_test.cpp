#include "modules/geometry/off_file.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/damaged_meshes.h"
#include "tests/scratch_folder.h"

namespace palpate::geometry {
namespace {

std::string refusal(const std::string& bytes) {
  return test::refusal_by(parse_off, bytes, "a.off");
}

TEST_CASE("off file: comments, blank lines, colours, and heads as they are met") {
  // Oracle: a pyramid's base, one side and an edge, by hand.
  const std::string counts = "5 3 8";
  const std::string head =
      GENERATE_COPY("OFF\n" + counts, "OFF " + counts, "OFF" + counts, counts,
                    "# by hand\r\nCOFF # colours\r\n" + counts, "STCNOFF\n" + counts);
  const TriangleSurface surface = parse_off(head +
                                                "\n\n0 0 0 255 0 0\n1 0 0 0.5\r\n1 +2.5 0\n# top\n"
                                                "0 2.5 0\n .1 3e-1 7\n4 3 2 1 0  0 0 255\n"
                                                "3 0 1 4\n2 0 4\n\n",
                                            "a.off");
  REQUIRE(surface.nodes.size() == 5);
  CHECK(surface.nodes[2] == Vec3(1, 2.5, 0));
  CHECK(surface.nodes[4] == Vec3(0.1, 0.3, 7));
  CHECK(surface.triangles == std::vector<Triangle>{{3, 2, 1}, {3, 1, 0}, {0, 1, 4}});
}

TEST_CASE("off file: what is wrong is named with its line") {
  // Oracle: the messages by hand.
  const std::string nodes = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
  CHECK(refusal("") == "a.off:0: must begin with 'OFF'");
  CHECK(refusal("solid\n") ==
        "a.off:1: 'solid' must be OFF, STOFF, COFF or NOFF: places of three numbers, as text");
  CHECK(refusal("4OFF\n3 1 0\n").starts_with("a.off:1: '4OFF' must be OFF"));
  CHECK(refusal("nOFF\n4\n3 1 0\n").starts_with("a.off:1: 'nOFF' must be OFF"));
  CHECK(refusal("OFF BINARY\n") ==
        "a.off:1: 'BINARY' must be the counts of vertices, faces and edges");
  CHECK(refusal("OFF\n3 -1 0\n").starts_with("a.off:2: '3 -1 0' must be the counts"));
  CHECK(refusal("OFF\n") == "a.off:1: the counts are not there");
  CHECK(refusal("OFF\n3 1 0\n0 0 0\n1 O 0\n") ==
        "a.off:4: vertex 1 of 3 is '1 O 0'; must be x y z");
  CHECK(refusal("OFF\n3 1 0\n0 0 0\n") ==
        "a.off:3: vertex 1 of 3 is not there: the file ends before");
  CHECK(refusal(nodes + "x 0 1 2\n") ==
        "a.off:6: face 0 of 1 begins with 'x'; must be how many corners it has");
  CHECK(refusal(nodes + "30 1 2\n") == "a.off:6: face 0 of 1 has 30 corners and names 2");
  CHECK(refusal(nodes + "3 0 1 3\n") == "a.off:6: face 0 of 1 names vertex 3; allowed: 0 to 2");
  CHECK(refusal(nodes + "3 0 1 -1\n") == "a.off:6: face 0 of 1 names vertex -1; allowed: 0 to 2");
  CHECK(refusal(nodes + "3 0 1 2\n3 0 2 1\n") == "a.off:7: '3 0 2 1' comes after the last face");
  CHECK(refusal("OFF\n3 1000000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n") ==
        "a.off:6: face 1 of 1000000000 is not there: the file ends before");
}

TEST_CASE("off file: 3,000 damaged files are read or refused") {
  // Oracle: no crash, where assimp had some twenty in 300 (the sanitizers' build looks closer), and
  // what is read names its own nodes. The first 300 come as files, as users' do.
  const ScratchFolder folder;
  write_surface(make_ball(0.05, 1), folder / "ball.off");
  test::DamagedFiles damaged(text_in(folder / "ball.off"));
  int read = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string bytes = damaged.next();
    try {
      const TriangleSurface surface = i < 300
                                          ? read_surface(folder.write("damaged.off", bytes), "m")
                                          : parse_off(bytes, "a.off");
      ++read;
      for (const Triangle& triangle : surface.triangles) {
        CHECK(std::ranges::max(triangle) < surface.nodes.size());
      }
    } catch (const InputError&) {
    }
  }
  CHECK(read > 0);
  CHECK(read < 3000);
}

TEST_CASE("off file: one that is known by its first word alone is read as strictly") {
  // Oracle: the message. assimp, which looks into files whose names say nothing, is not asked.
  const ScratchFolder folder;
  const std::string face = "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n";
  CHECK_THROWS_WITH(read_surface(folder.write("a.mesh3d", "OFF\n" + face), "m"),
                    Catch::EndsWith(":6: face 0 of 1 names vertex 7; allowed: 0 to 2"));
  CHECK_THROWS_WITH(read_surface(folder.write("b.mesh3d", "# by hand\nOFF\n" + face), "m"),
                    Catch::Contains("is not a surface mesh this program reads"));
}

}  // namespace
}  // namespace palpate::geometry
