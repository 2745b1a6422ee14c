#include "deformation/model/organ_model.h"

#include <catch2/catch.hpp>
#include <numeric>

#include "deformation/model/body.h"
#include "deformation/steppers/symplectic_euler.h"
#include "modules/core/error.h"
#include "tests/deformation/organs.h"
#include "tests/dense_algebra.h"

namespace palpate::deformation {
namespace {

using testing::ball_model;
using testing::ball_organ;

/// Dense M^-½ K M^-½ of the springs at rest (no tension: k u uᵀ blocks).
Eigen::MatrixXd dense_dynamic_matrix(const OrganModel& model) {
  const auto n = static_cast<Eigen::Index>(3 * model.node_count());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (const Spring& spring : model.network().springs) {
    const auto& x = model.rest_positions;
    const Vec3 u = (x[spring.node_b] - x[spring.node_a]).normalized();
    const Mat3 block = spring.stiffness * u * u.transpose();
    const auto a = static_cast<Eigen::Index>(3 * spring.node_a);
    const auto b = static_cast<Eigen::Index>(3 * spring.node_b);
    const double m_a = model.inverse_masses[spring.node_a];
    const double m_b = model.inverse_masses[spring.node_b];
    matrix.block<3, 3>(a, a) += m_a * block;
    matrix.block<3, 3>(b, b) += m_b * block;
    matrix.block<3, 3>(a, b) -= std::sqrt(m_a * m_b) * block;
    matrix.block<3, 3>(b, a) -= std::sqrt(m_a * m_b) * block;
  }
  return matrix;
}

TEST_CASE("organ model: masses sum to density times volume and fixed nodes have none to move") {
  // Oracle: invariant.
  auto organ = ball_organ();
  organ.fixed.push_back(scene::SphereRegion{Vec3(0, 0, -0.05), 0.02});
  const auto model = ball_model(2, organ);
  CHECK(std::accumulate(model.masses.begin(), model.masses.end(), 0.0) ==
        Approx(organ.tissue.density * model.rest_volume).epsilon(1e-12));
  REQUIRE(!model.fixed_nodes.empty());
  for (std::uint32_t i = 0; i < model.surface_node_count; ++i) {
    const bool inside = (model.rest_positions[i] - Vec3(0, 0, -0.05)).norm() <= 0.02;
    CHECK((model.inverse_masses[i] == 0) == inside);
  }
}

TEST_CASE("organ model: a box region fixes what lies inside it") {
  // Oracle: brute force.
  auto organ = ball_organ();
  organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, 0.03), Vec3(1, 1, 1)});
  const auto model = ball_model(2, organ);
  std::size_t expected = 0;
  for (std::size_t i = 0; i < model.surface_node_count; ++i) {
    expected += model.rest_positions[i].z() >= 0.03;
  }
  CHECK(model.fixed_nodes.size() == expected);
}

TEST_CASE("organ model: an organ with every node fixed is refused by name") {
  auto organ = ball_organ();
  organ.fixed.push_back(scene::SphereRegion{Vec3::Zero(), 1.0});
  CHECK_THROWS_WITH(ball_model(1, organ),
                    Catch::Contains("organ 'ball': key 'fixed' holds every one of its 42 nodes"));
}

TEST_CASE("organ model: an inside-out surface is refused") {
  auto ball = geometry::make_ball(0.05, 1);
  for (auto& triangle : ball.triangles) std::swap(triangle[0], triangle[1]);
  CHECK_THROWS_WITH(build_organ_model(ball_organ(), Vec3::Zero(), ball),
                    Catch::Contains("encloses no positive volume"));
}

TEST_CASE("stable step: Gershgorin's bound lies above the largest eigenvalue, by less than 3") {
  // Oracle: dense eigenvalues. The bound sums stiffness whatever its direction; a mode moves along
  // one of three, which at most costs the factor 3.
  const auto model = ball_model(2);
  const double largest = eigenvalues_of(dense_dynamic_matrix(model)).maxCoeff();
  const double bound = highest_squared_frequency_bound(model);
  CHECK(bound >= largest);
  CHECK(bound < 3 * largest);
}

TEST_CASE("stable step: without damping it is 2/ω of the bound, and damping shortens it") {
  // Oracle: analytic.
  auto organ = ball_organ();
  organ.tissue.damping_ratio = 0;
  organ.tissue.drag = 0;
  const auto undamped = ball_model(2, organ);
  CHECK(stable_step_bound(undamped) ==
        Approx(2 / std::sqrt(highest_squared_frequency_bound(undamped))).epsilon(1e-12));
  organ.tissue.damping_ratio = 0.3;
  CHECK(stable_step_bound(ball_model(2, organ)) < stable_step_bound(undamped));
}

TEST_CASE(
    "stable step: damped inner springs do not shorten it on a finer mesh more than the edges do") {
  // Oracle: scaling. Edge springs keep k and have m ∝ 1/nodes, so h ∝ 1/√nodes: halved per level.
  // 25 %: an icosphere's smallest nodes shrink a little faster than the mean.
  auto organ = ball_organ();
  organ.tissue.damping_ratio = GENERATE(0.1, 0.5);
  const double coarse = stable_step_bound(ball_model(2, organ));
  CHECK(stable_step_bound(ball_model(3, organ)) > 0.75 * coarse / 2);
  CHECK(stable_step_bound(ball_model(4, organ)) > 0.75 * coarse / 4);
}

/// Largest node distance from rest after `steps` steps of h from a small random-free disturbance.
double excursion(const OrganModel& model, double h, int steps, const KeptVolume& volume = {}) {
  auto state = rest_state(model);
  for (std::size_t i = 0; i < state.velocities.size(); ++i) {
    state.velocities[i] =
        1e-6 * Vec3(i % 3 == 0 ? 1 : -1, i % 5 == 0 ? -1 : 1, i % 7 == 0 ? 1 : -1);
  }
  StepBuffers buffers;
  for (int s = 0; s < steps; ++s) symplectic_euler_step(model, h, {}, state, buffers, volume);
  double largest = 0;
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    const double moved = (state.positions[i] - model.rest_positions[i]).norm();
    if (!(moved <= largest)) largest = moved;
  }
  return largest;
}

TEST_CASE("stable step: plain springs hold just below 2/ω_max and blow up just above it") {
  // Oracle: dense eigenvalues; ±3 % around 2/ω_max (4000 steps grow by e^(√…) only beyond that).
  auto organ = ball_organ();
  organ.tissue.damping_ratio = 0;
  organ.tissue.drag = 0;
  const auto model = ball_model(2, organ);
  const double omega = std::sqrt(eigenvalues_of(dense_dynamic_matrix(model)).maxCoeff());
  CHECK(excursion(model, 0.97 * 2 / omega, 4000, {.is_kept = false}) < 1e-4);
  CHECK_FALSE(excursion(model, 1.03 * 2 / omega, 4000, {.is_kept = false}) < 1e-4);
}

TEST_CASE("stable step: the bound is safe with damping and the volume constraint") {
  // Oracle: boundedness over 4000 steps at the bound.
  auto organ = ball_organ();
  organ.tissue.damping_ratio = GENERATE(0.0, 0.1, 0.5, 1.5);
  const auto model = ball_model(2, organ);
  CHECK(excursion(model, 0.9 * stable_step_bound(model), 4000) < 1e-4);
}

}  // namespace
}  // namespace palpate::deformation
