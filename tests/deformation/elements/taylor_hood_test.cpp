#include "deformation/elements/taylor_hood.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "solids.h"

namespace palpate::deformation {
namespace {

const Vec3 kSize(0.02, 0.03, 0.02);

TEST_CASE("Taylor–Hood elements: the tangent is the derivative of the residual, and symmetric") {
  // Oracle: central differences of the element's residual, 1e-6 of the largest entry.
  const auto solid = testing::solid(testing::block(kSize, 1, 1, 1), 0.45);
  auto state = testing::shaken(solid, 5e-4);
  ElementMatrix tangent;
  solid.tangent(2, state, tangent);
  CHECK((tangent - tangent.transpose()).norm() == 0);
  const auto& nodes = solid.mesh().elements[2];
  const auto derivative = [&](double& unknown, double step) {
    ElementVector up, down;
    const double at = unknown;
    unknown = at + step;
    REQUIRE(solid.residual(2, state, up));
    unknown = at - step;
    REQUIRE(solid.residual(2, state, down));
    unknown = at;
    return ElementVector((up - down) / (2 * step));
  };
  for (int a = 0; a < kElementNodes; ++a) {
    for (int i = 0; i < 3; ++i) {
      const auto column = derivative(state.positions[nodes[a]][i], 1e-8);
      const ElementVector error = column - tangent.col(3 * a + i);
      CHECK(error.head<30>().norm() < 1e-6 * tangent.topLeftCorner<30, 30>().norm());
      CHECK(error.tail<4>().norm() < 1e-6 * tangent.bottomLeftCorner<4, 30>().norm());
    }
  }
  for (int m = 0; m < 4; ++m) {
    const auto column = derivative(state.pressures[nodes[m]], 1.0);
    CHECK((column.head<30>() - tangent.col(30 + m).head<30>()).norm() <
          1e-9 * tangent.col(30 + m).head<30>().norm());
    CHECK((column.tail<4>() - tangent.col(30 + m).tail<4>()).norm() <
          1e-6 * tangent.col(30 + m).tail<4>().norm());
  }
}

TEST_CASE("Taylor–Hood elements: forces and moments of the whole vanish, rigid motion gives none") {
  // Oracle: invariance. Sums round at 1e-14 of the forces.
  const auto solid = testing::solid(testing::block(kSize, 2, 2, 2), 0.49);
  const auto state = testing::shaken(solid, 3e-4);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  double scale = 0;
  for (std::size_t e = 0; e < solid.element_count(); ++e) {
    ElementVector r;
    REQUIRE(solid.residual(e, state, r));
    for (int a = 0; a < kElementNodes; ++a) {
      sum += r.segment<3>(3 * a);
      moment += state.positions[solid.mesh().elements[e][a]].cross(r.segment<3>(3 * a));
      scale += r.segment<3>(3 * a).norm();
    }
  }
  CHECK(sum.norm() < 1e-13 * scale);
  CHECK(moment.norm() < 1e-13 * scale * kSize.norm());
  auto turned = solid.rest_state();
  const Mat3 R = Quat(0.5, 0.5, -0.5, 0.5).toRotationMatrix();
  for (Vec3& p : turned.positions) p = R * p + Vec3(1, -2, 3);
  ElementVector r;
  REQUIRE(solid.residual(0, turned, r));
  CHECK(r.norm() < 1e-11 * scale);  // the shift by metres costs digits
  CHECK(solid.energy(turned) < 1e-12);
}

TEST_CASE("Taylor–Hood elements: mass and volume are those of the block") {
  // Oracle: ρ V and V of a box; a swollen box.
  const auto solid = testing::solid(testing::block(kSize, 2, 1, 1), 0.3);
  double mass = 0;
  for (std::size_t e = 0; e < solid.element_count(); ++e) mass += solid.mass(e).sum();
  CHECK(mass == Approx(1000 * kSize.prod()));
  auto state = solid.rest_state();
  CHECK(solid.volume(state) == Approx(kSize.prod()));
  for (Vec3& p : state.positions) p *= 1.1;
  CHECK(solid.volume(state) == Approx(1.331 * kSize.prod()));
}

TEST_CASE("Taylor–Hood elements: an element inside out is refused at rest and reported in motion") {
  // Oracle: the stated behaviour.
  auto mesh = testing::block(kSize, 1, 1, 1);
  const auto good = testing::solid(mesh, 0.3);
  auto state = good.rest_state();
  for (Vec3& p : state.positions) p.x() = -p.x();
  ElementVector r;
  CHECK_FALSE(good.residual(0, state, r));
  std::swap(mesh.tetrahedra[3][0], mesh.tetrahedra[3][1]);
  CHECK_THROWS_WITH(testing::solid(mesh, 0.3),
                    Catch::Contains("tetrahedron 3: flat or inside out"));
}

}  // namespace
}  // namespace palpate::deformation
