#include "deformation/contact/rigid_contact.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "deformation/steppers/quasi_static_newton.h"
#include "tests/deformation/elements/solids.h"
#include "tests/dense_algebra.h"

namespace palpate::deformation {
namespace {

std::vector<std::uint32_t> all_faces(const TaylorHoodElements& solid) {
  std::vector<std::uint32_t> faces(solid.mesh().faces.size());
  std::iota(faces.begin(), faces.end(), 0u);
  return faces;
}

TEST_CASE("rigid contact: gap and normal of plane, sphere and capsule") {
  // Oracle: geometry; normal derivative by central differences, beside a capsule and at its ends.
  const Plane plane{Vec3(0, 0, 1), Vec3::UnitZ()};
  CHECK(gap_at(plane, {5, 5, 3}).gap == 2);
  const Capsule capsule{Vec3(1, 2, 3), Vec3(1, 2, 4), 0.5};
  CHECK(gap_at(capsule, {2, 2, 3.7}).gap == Approx(0.5));
  CHECK(gap_at(capsule, {1, 2, 5}).gap == Approx(0.5));
  const std::vector<std::pair<Obstacle, Vec3>> all{{Sphere{Vec3(1, 2, 3), 0.5}, {1.3, 2.4, 2.8}},
                                                   {capsule, {1.3, 2.4, 2.8}},
                                                   {capsule, {1.3, 2.4, 3.4}},
                                                   {capsule, {1.3, 2.4, 4.1}}};
  for (const auto& [obstacle, x] : all) {
    const auto at = gap_at(obstacle, x);
    for (int i = 0; i < 3; ++i) {
      const Vec3 step = 1e-6 * Vec3::Unit(i);
      const auto up = gap_at(obstacle, x + step), down = gap_at(obstacle, x - step);
      CHECK(at.normal[i] == Approx((up.gap - down.gap) / 2e-6));
      CHECK((at.normal_derivative.col(i) - (up.normal - down.normal) / 2e-6).norm() < 1e-8);
    }
  }
}

TEST_CASE("rigid contact: the tangent is the derivative of the forces") {
  // Oracle: central differences where no point opens or closes; t up to some 90 μ, as after a
  // stride.
  const auto solid = testing::solid(testing::block({0.02, 0.02, 0.02}, 1, 1, 1), 0.4);
  RigidContact contact(solid, all_faces(solid), 5e7);
  contact.set_obstacles({Sphere{Vec3(0.01, 0.01, 0.05), 0.031}});
  auto state = solid.rest_state();
  contact.augment(state);  // with multipliers, too
  double checked = 0;
  for (std::size_t e = 0; e < solid.element_count(); ++e) {
    ElementMatrix tangent = ElementMatrix::Zero();
    contact.add_tangent(e, state, tangent, false);
    for (int a = 0; a < kElementNodes; ++a) {
      for (int i = 0; i < 3; ++i) {
        double& unknown = state.positions[solid.mesh().elements[e][a]][i];
        const double at = unknown, step = 1e-9;
        ElementVector up = ElementVector::Zero(), down = up;
        unknown = at + step;
        contact.add_residual(e, state, up);
        unknown = at - step;
        contact.add_residual(e, state, down);
        unknown = at;
        CHECK(((up - down) / (2 * step) - tangent.col(3 * a + i)).norm() <= 1e-5 * tangent.norm());
      }
    }
    checked += tangent.norm();
  }
  CHECK(checked > 0);
}

TEST_CASE(
    "rigid contact: the tangent to go downhill by has no more than the derivative's descents") {
  // Oracle: eigenvalues of the difference, where t is above 4 μ and where it is below.
  const auto solid = testing::solid(testing::block({0.02, 0.02, 0.02}, 1, 1, 1), 0.4);
  for (const double penalty : {1e6, 5e7}) {
    RigidContact contact(solid, all_faces(solid), penalty);
    contact.set_obstacles({Sphere{Vec3(0.01, 0.01, 0.05), 0.031}});
    double largest = 0;
    for (std::size_t e = 0; e < solid.element_count(); ++e) {
      ElementMatrix derivative = ElementMatrix::Zero(), downhill = derivative;
      contact.add_tangent(e, solid.rest_state(), derivative, false);
      contact.add_tangent(e, solid.rest_state(), downhill, true);
      const Eigen::VectorXd more = eigenvalues_of(downhill - derivative);
      CHECK(more[0] >= -1e-12 * derivative.norm());
      largest = std::max(largest, more[kElementDofs - 1]);
    }
    CHECK((largest > 0) == (penalty > 1e6));
  }
}

TEST_CASE("rigid contact: a block between frictionless plates carries the uniaxial force") {
  // Oracle: incompressible uniaxial solution μ(λ − λ⁻²); force within 1e-4, no deeper than said.
  const auto solid = testing::solid(testing::block({0.02, 0.02, 0.02}, 2, 2, 2), 0.5);
  RigidContact contact(solid, all_faces(solid), 1e4 * 3000 / 0.02);
  QuasiStaticNewton solver(solid, testing::symmetry(solid), &contact);
  contact.set_obstacles({Plane{Vec3(0, 0, 0.016), -Vec3::UnitZ()}});
  auto state = solid.rest_state();
  const auto report = solver.solve(state);
  REQUIRE(report.converged);
  CHECK(report.deepest <= NewtonGoal().most_penetration * solid.size());
  const auto outcome = contact.outcomes(state)[0];
  const double stress = 1000 * (1 / (0.8 * 0.8) - 0.8);
  CHECK(outcome.force.z() == Approx(stress * 0.0004).epsilon(3e-4));  // 2e-5 of the size deep
  CHECK(outcome.force.head<2>().norm() == 0);
  CHECK(outcome.touching == 8 * 6);
}

}  // namespace
}  // namespace palpate::deformation
