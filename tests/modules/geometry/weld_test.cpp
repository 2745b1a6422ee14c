#include "modules/geometry/weld.h"

#include "modules/geometry/mesh_check.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;

TEST_CASE("weld: an exploded surface comes back with its node count, in order of appearance") {
  // Oracle: invariant, exploding and welding keep the shape.
  const TriangleSurface ball = make_ball(0.05, 2);
  TriangleSurface surface = exploded(ball);
  CHECK(weld_nodes(surface) == 3 * ball.triangles.size() - ball.nodes.size());
  CHECK(surface.nodes.size() == ball.nodes.size());
  CHECK(check_surface(surface).holds_volume());
  CHECK(surface.triangles[0] == Triangle{0, 1, 2});
  CHECK(weld_nodes(surface) == 0);
}

TEST_CASE("weld: zero and minus zero are one place, neighbouring numbers are two") {
  // Oracle: equality of doubles.
  TriangleSurface surface{{{0, 0, 0}, {-0.0, 0, 0}, {1, 0, 0}, {std::nextafter(1.0, 2.0), 0, 0}},
                          {{0, 2, 3}, {1, 2, 3}}};
  CHECK(weld_nodes(surface) == 1);
  CHECK(surface.triangles[0] == surface.triangles[1]);
}

TEST_CASE("cracks: nodes of open edges within the tolerance join, wider gaps stay open") {
  // Oracle: a ball whose triangles were pulled apart by known distances.
  const TriangleSurface ball = make_ball(0.05, 2);
  for (const auto& [gap, closes] : {std::pair{1e-9, true}, {1e-4, false}}) {
    TriangleSurface surface = exploded(ball);
    for (std::size_t i = 0; i < surface.nodes.size(); ++i) {
      surface.nodes[i] *= 1 + gap * static_cast<double>(i % 5) / 0.05;
    }
    weld_cracks(surface, 1e-7);
    CHECK(check_surface(surface).border_edges.empty() == closes);
  }
}

TEST_CASE("cracks: near nodes of a closed surface are left alone") {
  // Oracle: two closed tetrahedra almost touching.
  TriangleSurface surface = both(make_tetrahedron(0.1), moved(make_tetrahedron(0.1), {1e-9, 0, 0}));
  CHECK(weld_cracks(surface, 1e-6) == 0);
}

TEST_CASE("unused nodes: are dropped, the others keep their order") {
  // Oracle: hand-made.
  TriangleSurface surface{{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {8, 8, 8}, {0, 1, 0}}, {{1, 2, 4}}};
  CHECK(drop_unused_nodes(surface) == 2);
  CHECK(surface.nodes == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  CHECK(surface.triangles[0] == Triangle{0, 1, 2});
}
