#include "studies/truth/pressed_solid.h"

#include <catch2/catch.hpp>

#include "modules/geometry/bisection.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::truth {
namespace {

TEST_CASE("truth: a state goes over to a finer mesh as the function it is") {
  // Oracle: a quadratic map, which quadratic elements hold exactly, and a linear pressure.
  if (geometry::testing::without_gmsh()) return;
  const auto mesh = geometry::mesh_block({0, 0, 0}, {0.04, 0.04, 0.04}, "0.02 + 0*x");
  const auto fine_mesh = geometry::bisected(
      mesh, [](const Vec3& x) { return 0.006 + 0.6 * (x - Vec3(0.02, 0.02, 0.04)).norm(); }, 5000);
  const Body body{mesh, deformation::ElasticConstants(5e3, 0.499),
                  [](const Vec3&) { return false; }};
  const std::vector<Station> stations{{{{0.02, 0.02, 0.05}, {0.02, 0.02, 0.05}, 0.01}}};
  const PressedSolid coarse(mesh, body, stations), fine(fine_mesh, body, stations);
  REQUIRE(fine.node_count() > 2 * coarse.node_count());
  const auto map = [](const Vec3& x) -> Vec3 { return x + x.z() * Vec3(x.y(), 2 * x.z(), x.x()); };
  const auto expected_of = [&](const PressedSolid& solid) {
    auto state = solid.rest_state();
    for (Vec3& x : state.positions) x = map(x);
    for (Eigen::Index i = 0; i < state.pressures.size(); ++i) {
      const Vec3 x = solid.rest_state().positions[static_cast<std::size_t>(i)];
      state.pressures[i] = 100 * x.x() - 50 * x.z();
    }
    return state;
  };
  const auto found = fine.refined(coarse, expected_of(coarse)), expected = expected_of(fine);
  for (std::size_t i = 0; i < found.positions.size(); ++i) {
    CHECK((found.positions[i] - expected.positions[i]).norm() < 1e-12);
  }
  CHECK((found.pressures - expected.pressures).cwiseAbs().maxCoeff() < 1e-9);
}

}  // namespace
}  // namespace palpate::truth
