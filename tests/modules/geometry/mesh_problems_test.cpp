#include "modules/geometry/mesh_check.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;
using Catch::Contains;

namespace {

std::vector<std::string> problems_of(const TriangleSurface& surface) {
  return describe_problems(check_surface(surface), surface);
}

}  // namespace

TEST_CASE("problems: none are told of a sound surface") {
  // Oracle: invariant: silent iff the surface holds a volume.
  CHECK(problems_of(make_ball(0.05, 2)).empty());
}

TEST_CASE("problems: an open edge is told with nodes, position and remedy") {
  // Oracle: hand-made: nodes of a box at known corners.
  TriangleSurface surface = make_box({2, 2, 2});
  surface.triangles.pop_back();
  const auto lines = problems_of(surface);
  REQUIRE(lines.size() == 1);
  const auto edge = check_surface(surface).border_edges[0];
  CHECK_THAT(lines[0], Contains("3 open edges") && Contains("fill its holes") &&
                           Contains("nodes " + std::to_string(edge[0]) + "–" +
                                    std::to_string(edge[1]) + " at (") &&
                           Contains(") m"));
}

TEST_CASE("problems: each fault has its own line with what to do") {
  // Oracle: hand-made faults.
  TriangleSurface fin = make_tetrahedron(1);
  fin.nodes.push_back({3, 3, 3});
  fin.triangles.push_back({0, 1, 4});
  const auto fin_lines = problems_of(fin);
  REQUIRE(fin_lines.size() == 2);
  CHECK_THAT(fin_lines[0], Contains("2 open edges"));
  CHECK_THAT(fin_lines[1], Contains("1 edge with more than two triangles: nodes 0–1") &&
                               Contains("remove the inner walls or flaps"));

  const auto shells = problems_of(both(make_ball(1, 1), moved(make_ball(1, 1), {5, 0, 0})));
  REQUIRE(shells.size() == 1);
  CHECK_THAT(shells[0], Contains("2 separate shells") && Contains("one organ is one shell"));

  const auto turned = problems_of(inside_out(make_ball(1, 1)));
  REQUIRE(turned.size() == 1);
  CHECK_THAT(turned[0], Contains("inside out") && Contains("flip"));

  TriangleSurface one_turned = make_ball(1, 1);
  std::swap(one_turned.triangles[5][0], one_turned.triangles[5][1]);
  CHECK_THAT(problems_of(one_turned)[0], Contains("3 edges between oppositely oriented"));
}

TEST_CASE("problems: faults of triangles and nodes are told by index") {
  // Oracle: hand-made faults.
  TriangleSurface surface = make_tetrahedron(1);
  surface.triangles.push_back({3, 3, 1});
  surface.nodes.push_back({7, 8, 9});
  const auto lines = problems_of(surface);
  REQUIRE_FALSE(lines.empty());
  const std::string all = lines.back() + lines[lines.size() - 2];
  CHECK_THAT(all, Contains("1 triangle without area: triangle 4") &&
                      Contains("1 node of no triangle: node 4 at (7, 8, 9) m"));

  TriangleSurface twice = make_tetrahedron(1);
  twice.triangles.push_back({2, 0, 1});
  CHECK_THAT(problems_of(twice).back(), Contains("1 duplicate triangle: triangle 4"));
}

TEST_CASE("problems: crossing triangles are told in pairs") {
  // Oracle: hand-made.
  TriangleSurface surface = make_ball(1, 2);
  for (Vec3& node : surface.nodes) {
    if (node.z() > 0.9) node.z() = -1.5;
  }
  const auto lines = problems_of(surface);
  REQUIRE_FALSE(lines.empty());
  CHECK_THAT(lines.back(), Contains("pairs of triangles pass through each other, the first: "
                                    "triangle ") &&
                               Contains("and triangle ") && Contains("mesh editor"));
}

TEST_CASE("problems: nodes where shells touch, empty and flat surfaces are told") {
  // Oracle: hand-made; the flat one is a triangle used from both sides.
  CHECK_THAT(problems_of({})[0], Contains("no triangles"));
  const TriangleSurface flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  CHECK_FALSE(problems_of(flat).empty());
  const TriangleSurface pinched{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
      {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}}};
  CHECK_THAT(problems_of(pinched)[0],
             Contains("touch only in a point: node 0 at (0, 0, 0) m") && Contains("separate"));
}
