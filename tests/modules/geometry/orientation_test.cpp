#include "modules/geometry/orientation.h"

#include <random>

#include "modules/geometry/mesh_check.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;

TEST_CASE("orientation: a surface with a third of its triangles turned becomes as it was") {
  // Oracle: the surface before the triangles were turned.
  const TriangleSurface ball = make_ball(0.05, 2);
  TriangleSurface surface = ball;
  std::mt19937 random(3);
  std::size_t turned = 0;
  for (Triangle& triangle : surface.triangles) {
    if (random() % 3 != 0) continue;
    std::swap(triangle[1], triangle[2]);
    ++turned;
  }
  const OrientationLog log = orient_outward(surface);
  CHECK(log.flipped_triangles == turned);
  CHECK(log.flipped_shells == 0);
  CHECK(surface.triangles == ball.triangles);
}

TEST_CASE("orientation: each shell turns outward by itself") {
  // Oracle: volumes of a ball and a box, one of them inside out.
  const TriangleSurface ball = make_ball(0.05, 1), box = moved(make_box({1, 1, 1}), {3, 0, 0});
  TriangleSurface surface = both(inside_out(ball), box);
  const OrientationLog log = orient_outward(surface);
  CHECK(log.flipped_shells == 1);
  CHECK(log.flipped_triangles == 0);
  CHECK(enclosed_volume(surface.nodes, surface.triangles) ==
        Approx(enclosed_volume(ball.nodes, ball.triangles) + 1).epsilon(1e-12));
}

TEST_CASE("orientation: an open shell is made consistent but not judged inside out") {
  // Oracle: hand-made: a box without one triangle, another one turned.
  TriangleSurface surface = inside_out(make_box({1, 1, 1}));
  surface.triangles.pop_back();
  const TriangleSurface before = surface;
  std::swap(surface.triangles[4][0], surface.triangles[4][1]);
  CHECK(orient_outward(surface).flipped_triangles == 1);
  CHECK(check_surface(surface).inconsistent_edges.empty());
  CHECK(surface.triangles[0] == before.triangles[0]);
}

TEST_CASE("orientation: a Möbius strip keeps a disagreeing edge") {
  // Oracle: topology: a strip of five triangles closed with a half turn has one side only.
  TriangleSurface surface;
  for (std::uint32_t i = 0; i < 5; ++i) {
    const double angle = 2 * 3.14159265358979 * i / 5;
    surface.nodes.push_back({std::cos(angle), std::sin(angle), 0.3 * (i % 2)});
    surface.triangles.push_back({i, (i + 1) % 5, (i + 2) % 5});
  }
  orient_outward(surface);
  CHECK_FALSE(check_surface(surface).inconsistent_edges.empty());
}
