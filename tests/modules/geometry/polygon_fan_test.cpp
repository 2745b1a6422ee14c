#include "modules/geometry/polygon_fan.h"

#include <catch2/catch.hpp>
#include <numeric>

namespace palpate::geometry {
namespace {

/// All corners, from one of them on, in a plane.
TriangleSurface fan_of(const std::vector<Vec3>& nodes, std::uint32_t first) {
  TriangleSurface surface{nodes, {}};
  std::vector<std::uint32_t> corners(nodes.size());
  std::iota(corners.begin(), corners.end(), 0u);
  std::ranges::rotate(corners, corners.begin() + first);
  add_fan(corners, surface);
  return surface;
}

double sum_of_areas(const TriangleSurface& surface) {
  double sum = 0;
  for (const Triangle& t : surface.triangles) {
    const Vec3& a = surface.nodes[t[0]];
    sum += 0.5 * (surface.nodes[t[1]] - a).cross(surface.nodes[t[2]] - a).norm();
  }
  return sum;
}

TEST_CASE("polygon fan: hollow polygons are cut from a corner that turns no triangle over") {
  // Oracle: areas by the shoelace formula; where a triangle is turned over, sizes add up to more.
  const std::vector<Vec3> arrow{{0, 0, 0}, {3, 0, 0}, {1, 1, 0}, {0, 3, 0}};
  const std::vector<Vec3> notch{{0, 0, 0},   {2, 0, 0},   {2, 2, 0},
                                {1, 0.5, 0}, {0.5, 2, 0}, {0, 2, 0}};
  for (std::uint32_t first = 0; first < 4; ++first) {
    const TriangleSurface surface = fan_of(arrow, first);
    CHECK(surface.triangles.size() == 2);
    CHECK(sum_of_areas(surface) == Approx(3).epsilon(1e-14));
  }
  for (std::uint32_t first = 0; first < 6; ++first) {
    const TriangleSurface surface = fan_of(notch, first);
    CHECK(surface.triangles.size() == 4);
    CHECK(sum_of_areas(surface) == Approx(2.875).epsilon(1e-14));
  }
}

TEST_CASE("polygon fan: a convex one is cut from its first corner, fewer than three make none") {
  // Oracle: by hand.
  const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  CHECK(fan_of(square, 1).triangles == std::vector<Triangle>{{1, 2, 3}, {1, 3, 0}});
  CHECK(fan_of({{0, 0, 0}, {1, 0, 0}}, 0).triangles.empty());
  CHECK(fan_of({}, 0).triangles.empty());
}

}  // namespace
}  // namespace palpate::geometry
