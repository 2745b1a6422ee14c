#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;
using Catch::Contains;

namespace {

std::string all_of(const RepairLog& log) {
  std::string text;
  for (const std::string& action : log.actions) text += action + '\n';
  return text;
}

}  // namespace

TEST_CASE("repair: a sound surface is not touched and nothing is logged") {
  // Oracle: identity.
  TriangleSurface surface = make_ball(0.05, 2);
  const TriangleSurface before = surface;
  CHECK(repair_surface(surface).actions.empty());
  CHECK(surface.nodes == before.nodes);
  CHECK(surface.triangles == before.triangles);
}

TEST_CASE("repair: everything at once comes back to a sound surface, each action logged") {
  // Oracle: the volume of the surface before it was damaged.
  const TriangleSurface ball = make_ball(0.05, 2);
  TriangleSurface surface = inside_out(exploded(ball));
  std::swap(surface.triangles[7][0], surface.triangles[7][1]);
  surface.triangles.push_back(surface.triangles[3]);
  surface.triangles.push_back({4, 4, 9});
  surface.nodes.push_back({1, 1, 1});
  const std::string log = all_of(repair_surface(surface));
  const MeshReport report = check_surface(surface);
  CHECK(report.holds_volume());
  CHECK(report.node_count == ball.nodes.size());
  CHECK(report.volume == Approx(enclosed_volume(ball.nodes, ball.triangles)).epsilon(1e-13));
  CHECK_THAT(log, Contains("nodes at the same place joined: 798") &&
                      Contains("two corners at one place dropped: 1") &&
                      Contains("lying on each other dropped: 1") &&
                      Contains("nodes of no triangle dropped: 1") &&
                      Contains("turned to agree with their neighbours: 1") &&
                      Contains("inside out turned outward: 1"));
}

TEST_CASE("repair: rounding cracks close, real holes stay") {
  // Oracle: hand-made gaps of 1e-8 and of one triangle.
  TriangleSurface cracked = exploded(make_ball(0.05, 2));
  for (std::size_t i = 0; i < cracked.nodes.size(); ++i) {
    cracked.nodes[i].z() += 1e-9 * static_cast<double>(i % 7);
  }
  CHECK_THAT(all_of(repair_surface(cracked)), Contains("cracks thinner than 1e-6"));
  CHECK(check_surface(cracked).holds_volume());
  TriangleSurface holed = make_ball(0.05, 2);
  holed.triangles.pop_back();
  CHECK(repair_surface(holed).actions.empty());
  CHECK(check_surface(holed).border_edges.size() == 3);
}

TEST_CASE("repair: a doubled wall between two joined solids goes, a doubled skin stays once") {
  // Oracle: hand-made: two cubes sharing a face; a ball with every triangle twice.
  TriangleSurface cubes = both(make_box({1, 1, 1}), moved(make_box({1, 1, 1}), {0, 0, 1}));
  CHECK_THAT(all_of(repair_surface(cubes)), Contains("lying on each other dropped: 4"));
  const MeshReport joined = check_surface(cubes);
  CHECK(joined.border_edges.empty());
  CHECK(joined.holds_volume());
  CHECK(joined.volume == Approx(2).epsilon(1e-14));

  const TriangleSurface ball = make_ball(1, 1);
  TriangleSurface doubled = both(ball, inside_out(ball));
  repair_surface(doubled);
  CHECK(doubled.triangles.size() == ball.triangles.size());
  CHECK(check_surface(doubled).holds_volume());
}

TEST_CASE("repair: a sliver without area is flipped away") {
  // Oracle: invariant volume; three nodes on one line, as CAD tessellators leave them.
  TriangleSurface surface = make_tetrahedron(1);
  const auto [a, b, c] = surface.triangles[0];
  surface.nodes.push_back((surface.nodes[a] + surface.nodes[b]) / 2);
  surface.triangles[0] = {a, 4, c};
  surface.triangles.push_back({4, b, c});
  surface.triangles.push_back({a, b, 4});
  CHECK_THAT(all_of(repair_surface(surface)), Contains("without area flipped"));
  CHECK(check_surface(surface).holds_volume());
}

TEST_CASE("repair: several shells are each turned outward") {
  // Oracle: the sum of the volumes.
  TriangleSurface surface =
      both(inside_out(make_box({1, 1, 1})), inside_out(moved(make_box({1, 1, 1}), {4, 0, 0})));
  CHECK_THAT(all_of(repair_surface(surface)), Contains("turned outward: 2"));
  CHECK(enclosed_volume(surface.nodes, surface.triangles) == Approx(2).epsilon(1e-14));
}
