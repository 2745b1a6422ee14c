#include "collision/organ_surface.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "modules/geometry/primitives.h"

namespace palpate::collision {

TEST_CASE("organ surface: edges and triangles around nodes of a ball") {
  // Oracle: Euler's formula, E = 3 F / 2 and every edge between two triangles.
  const auto ball = geometry::make_ball(1, 2);
  const OrganSurface organ(ball.triangles);
  CHECK(organ.edges().size() == geometry::edges_of(ball.triangles).size());
  CHECK(2 * organ.edges().size() == 3 * ball.triangles.size());
  std::size_t sides = 0;
  for (std::uint32_t t = 0; t < ball.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const SurfaceEdge& edge = organ.edges()[organ.edges_of_triangle(t)[k]];
      CHECK((edge.triangles[0] == t || edge.triangles[1] == t));
      CHECK(edge.triangles[0] < edge.triangles[1]);
      const auto [a, b] = std::minmax(ball.triangles[t][k], ball.triangles[t][(k + 1) % 3]);
      CHECK(edge.nodes == std::array{a, b});
    }
  }
  for (std::uint32_t node = 0; node < ball.nodes.size(); ++node) {
    const auto around = organ.triangles_of_node(node);
    CHECK(std::is_sorted(around.begin(), around.end()));
    sides += around.size();
  }
  CHECK(sides == 3 * ball.triangles.size());
}

TEST_CASE("organ surface: a border edge names its triangle twice") {
  // Oracle: analytic.
  const OrganSurface organ({{0, 1, 2}});
  REQUIRE(organ.edges().size() == 3);
  for (const SurfaceEdge& edge : organ.edges()) CHECK(edge.triangles == std::array{0u, 0u});
}

TEST_CASE("organ surface: keeps the positions before the newest, if something was found on them") {
  // Oracle: analytic.
  OrganSurface organ({{0, 1, 2}});
  const auto shifted = [](double by) {
    return std::vector<Vec3>{Vec3(by, 0, 0), Vec3(1 + by, 0, 0), Vec3(by, 1, 0)};
  };
  CHECK_FALSE(organ.present());
  organ.update(shifted(0));
  const auto first = organ.version();
  CHECK(organ.positions_at(first) == shifted(0));
  organ.mark_found();
  organ.update(shifted(1));
  CHECK(organ.positions_at(first) == shifted(0));
  CHECK(organ.displacement_since(first) == 1);
  organ.update(shifted(3));  // nothing was found on the second
  CHECK(organ.positions_at(first) == shifted(0));
  CHECK(organ.displacement_since(first) == 3);
  CHECK(organ.positions_at(organ.version()) == shifted(3));
  CHECK(organ.displacement_since(organ.version()) == 0);
  organ.mark_found();
  organ.update(shifted(4));
  CHECK(organ.positions_at(first) == shifted(4));  // forgotten: taken as at rest
  CHECK(organ.displacement_since(first) == 0);
}

TEST_CASE(
    "organ surface: positions beyond its nodes are not looked at, not finite ones take it out") {
  // Oracle: analytic.
  OrganSurface organ({{0, 1, 2}});
  std::vector<Vec3> nodes{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(NAN, 0, 0)};
  organ.update(nodes);
  CHECK(organ.present());
  CHECK(organ.positions().size() == 3);
  nodes[1][2] = INFINITY;
  organ.update(nodes);
  CHECK_FALSE(organ.present());
  nodes[1][2] = 0;
  organ.mark_found();
  organ.update(nodes);
  CHECK(organ.present());
  CHECK(organ.displacement_since(1) == 0);
}

}  // namespace palpate::collision
