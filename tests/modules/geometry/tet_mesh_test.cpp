#include "modules/geometry/tet_mesh.h"

#include <catch2/catch.hpp>

#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::geometry {
namespace {

TEST_CASE("tet mesh: the boundary of a block is closed, outward and encloses the tetrahedra") {
  // Oracle: divergence theorem against the sum of the tetrahedra; counts 12 n² triangles.
  const auto mesh = testing::block({0.1, 0.2, 0.3}, 3, 3, 3);
  const double volume = testing::volume_of(mesh);
  const auto boundary = boundary_triangles(mesh);
  REQUIRE(boundary.size() == 12 * 9);
  std::vector<Triangle> triangles;
  for (const auto& triangle : boundary) triangles.push_back(triangle.nodes);
  CHECK(volume == Approx(0.006));
  for (const double v : three_axis_volumes(mesh.nodes, triangles)) {
    CHECK(v == Approx(volume));
  }
}

}  // namespace
}  // namespace palpate::geometry
