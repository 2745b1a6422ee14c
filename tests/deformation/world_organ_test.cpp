#include "deformation/world_organ.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "organs.h"
#include "tests/dense_algebra.h"

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

}  // namespace
}  // namespace palpate::deformation
