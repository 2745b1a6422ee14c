#include "modules/geometry/triangle_fans.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "modules/geometry/primitives.h"

namespace palpate::geometry {
namespace {

Triangle lowest_first(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

TriangleSurface some_surface() {
  return GENERATE(make_ball(0.05, 2), make_tetrahedron(0.1), make_box(Vec3(0.1, 0.06, 0.08), 3),
                  make_capsule(0.03, 0.1, 30));
}

TEST_CASE("one-rings: each follows the triangles around its node") {
  // Oracle: brute force. Every triangle (i, j, k) makes k the successor of j in the ring of i.
  const auto ball = make_ball(0.05, 2);
  const auto rings = ordered_one_rings(ball.triangles, ball.nodes.size());
  std::size_t steps = 0;
  for (const auto& ring : rings) steps += ring.size();
  CHECK(steps == 3 * ball.triangles.size());
  for (const auto& triangle : ball.triangles) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto& ring = rings[triangle[corner]];
      const auto from = std::find(ring.begin(), ring.end(), triangle[(corner + 1) % 3]);
      REQUIRE(from != ring.end());
      const auto to = std::next(from) == ring.end() ? ring.begin() : std::next(from);
      CHECK(*to == triangle[(corner + 2) % 3]);
    }
  }
}

TEST_CASE("fans: each triangle once, as it is oriented") {
  // Oracle: the triangles.
  const auto surface = some_surface();
  std::multiset<Triangle> expected, found;
  for (const auto& triangle : surface.triangles) expected.insert(lowest_first(triangle));
  const auto fans = fans_of(ordered_one_rings(surface.triangles, surface.nodes.size()));
  for (const Fan& fan : fans) {
    REQUIRE(fan.nodes.size() >= 2);
    for (std::size_t k = 0; k + 1 < fan.nodes.size(); ++k) {
      found.insert(lowest_first({fan.center, fan.nodes[k], fan.nodes[k + 1]}));
    }
  }
  CHECK(found == expected);
}

}  // namespace
}  // namespace palpate::geometry
