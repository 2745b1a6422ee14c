#include "modules/geometry/inner_lines.h"

#include <catch2/catch.hpp>

#include "modules/geometry/closest_points.h"
#include "modules/geometry/primitives.h"
#include "modules/geometry/winding_number.h"

namespace palpate::geometry {
namespace {

/// Some, none nearer to the surface than its radius.
std::vector<RoundedSegment> check_within(const ProbeForm& form, const TriangleSurface& surface) {
  const auto lines = inner_lines(form);
  CHECK_FALSE(lines.empty());
  for (const RoundedSegment& line : lines) {
    CHECK(line.radius > 0);
    for (int i = 0; i <= 20; ++i) {
      const Vec3 p = line.a + i / 20.0 * (line.b - line.a);
      CHECK(winding_number(p, surface.nodes, surface.triangles) > 0.5);
      for (const auto& [a, b, c] : surface.triangles) {
        const auto at =
            closest_on_triangle(p, {surface.nodes[a], surface.nodes[b], surface.nodes[c]});
        REQUIRE((at.point - p).norm() > line.radius * (1 - 1e-9));
      }
    }
  }
  return lines;
}

}  // namespace

TEST_CASE("inner lines: all of them are within their tool, whatever its size") {
  // Oracle: geometry: winding number, and the distance of places on them from every triangle.
  for (const double size : {1e-3, 0.3}) {
    const auto ball = make_ball(size, 2), block = make_box({size, size, 3 * size});
    check_within(ball, ball);
    check_within(block, block);
    CHECK(check_within(Box{{size, size, 3 * size}}, block).size() == 24);
  }
  CHECK(inner_lines(TriangleSurface{}).empty());
  CHECK(inner_lines(HalfSpace{}).empty());
  CHECK(inner_lines(RoundedSegment{}).empty());
}

TEST_CASE("inner lines: they reach into a sharp tip") {
  // Oracle: analytic, the tip is at the origin. A line's end lies three insets within.
  const auto cone = make_cone(0.002, 0.02, 32);
  double nearest = 1;
  for (const RoundedSegment& line : check_within(cone, cone)) {
    nearest = std::min({nearest, line.a.norm(), line.b.norm()});
  }
  CHECK(nearest == Approx(3 * inner_inset(0.004)).epsilon(0.01));
}

}  // namespace palpate::geometry
