#include "deformation/world_organ.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "organs.h"
#include "tests/dense_algebra.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::deformation {
namespace {

using testing::ball_organ;
using testing::ball_scene;
using testing::kBallRadius;

WorldOrgan make_ball_organ(const scene::Scene& scene, double radius = kBallRadius) {
  return make_organ(scene, 0, geometry::make_ball(radius, 2), nullptr, Guarding::kOn);
}

TEST_CASE("world organ: one that would need steps below 1 µs is refused by name") {
  // Oracle: definition.
  auto organ = ball_organ();
  organ.tissue.youngs_modulus = 1e7;
  organ.tissue.wall_thickness = 0.05;
  organ.tissue.density = 100;
  organ.integrator = scene::Integrator::kSymplecticEuler;
  CHECK_THROWS_WITH(make_ball_organ(ball_scene(1, organ), 1e-4),
                    Catch::Contains("organ 'ball': its largest stable step is"));
}

TEST_CASE("world organ: where organs may touch, an integrator left open is symplectic Euler") {
  // Oracle: definition. This wall is so stiff that alone it takes backward Euler.
  auto organ = ball_organ();
  organ.tissue.youngs_modulus = 1e8;
  organ.integrator = scene::Integrator::kAutomatic;
  scene::Scene scene = ball_scene(1, organ);
  CHECK(make_ball_organ(scene).simulated.dynamics().is_implicit());
  scene.contacts.self = true;
  CHECK(!make_ball_organ(scene).simulated.dynamics().is_implicit());
}

TEST_CASE("world organ: the compliance of rows over a period is symmetric and positive") {
  // Oracle: Maxwell and Betti, positive energy; float32 sums of the patch.
  WorldOrgan organ = make_ball_organ(ball_scene(1));
  const auto& triangle = organ.simulated.model().triangles.front();
  std::vector<ComplianceRow> rows;
  for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
    rows.push_back({{{triangle[0], 0.5}, {triangle[1], 0.5}}, axis});
    rows.push_back({{{triangle[2], 1.0}}, axis});
  }
  const Eigen::MatrixXd W = organ.contact_compliance(rows, 4e-3);
  CHECK((W - W.transpose()).norm() <= 1e-6 * W.norm());
  CHECK(eigenvalues_of(W).minCoeff() > 0);
}

TEST_CASE("world organ: where touched tissue moves fast a law is of the step to come") {
  // Oracle: definition. A block of quadratic tetrahedra falls by a hundredth of its edges in a
  // step, and by a tenth: where its matrix was taken, when a row's compliance was told.
  const auto shape = geometry::with_edge_nodes(
      geometry::shape_of(geometry::testing::block(Vec3(0.04, 0.04, 0.04), 2, 2, 2)));
  auto organ = ball_organ();
  organ.model = "quadratic_pressure";
  organ.fixed = {};
  scene::Scene scene = ball_scene(1, organ);
  scene.rates.deformation = 100;
  for (const double part : {0.01, 0.1}) {
    WorldOrgan block = make_organ(scene, 0, shape, nullptr, Guarding::kOn);
    const double period = 0.01;
    OrganState state = block.simulated.state();
    for (Vec3& v : state.velocities) v.z() = -part * block.mean_edge / period;
    block.simulated.put(state);
    AdvanceReport report;
    block.simulated.step(0, period, {}, report);
    const auto ahead = [&](std::uint32_t node) -> Vec3 {
      const OrganState& now = block.simulated.state();
      return now.positions[node] + period * now.velocities[node];
    };
    const std::uint32_t touched = block.simulated.model().triangles.front()[0];
    const auto taken = [&] { return block.simulated.dynamics().step_matrix().positions[touched]; };
    const Vec3 last = taken();
    CHECK(last != ahead(touched));
    const std::vector<ComplianceRow> row{{{{touched, 1.0}}, Vec3::UnitZ()}};
    CHECK(block.contact_compliance(row, period)(0, 0) > 0);
    CHECK(taken() == (part > 0.05 ? ahead(touched) : last));
  }
}

}  // namespace
}  // namespace palpate::deformation
