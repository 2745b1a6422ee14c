#include "deformation/steppers/implicit_motion.h"

#include <catch2/catch.hpp>

#include "deformation/steppers/vibration.h"
#include "tests/deformation/elements/solids.h"

namespace palpate::elements {
namespace {

TEST_CASE("implicit motion: a free body keeps its velocity") {
  // Oracle: Newton's first law; position error is Newton's tolerance.
  const auto solid = testing::solid(testing::block({0.02, 0.02, 0.02}, 1, 1, 1), 0.5);
  EquilibriumSolver solver(solid, std::vector<char>(solid.displacement_count(), 0), nullptr);
  const Vec3 v(0.1, -0.2, 0.3);
  ImplicitMotion motion(solver, solid.rest_state(),
                        std::vector<Vec3>(solid.mesh().nodes.size(), v));
  for (int s = 0; s < 5; ++s) REQUIRE(motion.step(0.01).converged);
  for (std::size_t i = 0; i < solid.mesh().nodes.size(); ++i) {
    CHECK((motion.state().positions[i] - solid.mesh().nodes[i] - 0.05 * v).norm() < 1e-8);
  }
}

/// Distance from where a mode started, after one period in `steps` steps, over the amplitude.
double error_after_a_period(const MixedSolid& solid, const std::vector<char>& held,
                            const Vibration& vibration, int steps) {
  const Eigen::VectorXd mode =
      vibration.modes.col(0) / vibration.modes.col(0).cwiseAbs().maxCoeff();
  const double amplitude = 1e-6, omega = vibration.angular_frequencies[0];
  std::vector<Vec3> velocities;
  for (std::size_t i = 0; i < solid.mesh().nodes.size(); ++i) {
    velocities.push_back(amplitude * omega * mode.segment<3>(static_cast<Eigen::Index>(3 * i)));
  }
  EquilibriumSolver solver(solid, held, nullptr);
  ImplicitMotion motion(solver, solid.rest_state(), velocities);
  for (int s = 0; s < steps; ++s) {
    REQUIRE(motion.step(2 * 3.14159265358979 / omega / steps).converged);
  }
  double error = 0;
  for (std::size_t i = 0; i < solid.mesh().nodes.size(); ++i) {
    error = std::max(error, (motion.state().positions[i] - solid.mesh().nodes[i]).norm());
  }
  return error / amplitude;
}

TEST_CASE("implicit motion: a mode swings with its frequency, error of second order in the step") {
  // Oracle: the eigenproblem. After a period the displacement is zero again; BDF2's period is
  // longer by (ωh)²/3 of it: 2π (2π/n)²/3. The mode's shape is that of small displacements: 1e-6 of
  // 0.05 m.
  const auto solid = testing::solid(testing::block({0.02, 0.02, 0.05}, 1, 1, 2), 0.49);
  std::vector<char> held(solid.displacement_count(), 0);
  for (std::size_t i = 0; i < solid.mesh().nodes.size(); ++i) {
    if (solid.mesh().nodes[i].z() == 0) held[3 * i] = held[3 * i + 1] = held[3 * i + 2] = 1;
  }
  const auto vibration = vibrate(solid, held, 1);
  const double coarse = error_after_a_period(solid, held, vibration, 40);
  const double fine = error_after_a_period(solid, held, vibration, 80);
  CHECK(coarse < 0.08);
  CHECK(coarse / fine > 3);
  CHECK(coarse / fine < 5);
}

}  // namespace
}  // namespace palpate::elements
