// How fast the answer settles as steps are halved: the order of each integrator.
#include <catch2/catch.hpp>

#include "deformation/backward_euler.h"
#include "deformation/symplectic_euler.h"
#include "tests/stability/organs_under_test.h"

namespace palpate::deformation {
namespace {

constexpr double kTime = 0.1;  // [s]; a third of the slowest swing

struct Result {
  std::vector<Vec3> positions;
  double energy = 0;  ///< [J]
};

/// A ball let go from an ellipsoid of the same volume, in `steps` steps.
Result let_go(OrganDynamics& dynamics, const OrganModel& model, int steps) {
  OrganState state = rest_state(model);
  for (Vec3& p : state.positions) p = Vec3(1.1 * p.x(), p.y(), p.z() / 1.1);
  for (int s = 0; s < steps; ++s) dynamics.step(kTime / steps, {}, state);
  Result result{state.positions, dynamics.elastic_energy(state)};
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    result.energy += model.masses[i] * state.velocities[i].squaredNorm() / 2;
  }
  return result;
}

double distance(const Result& a, const Result& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    sum += (a.positions[i] - b.positions[i]).squaredNorm();
  }
  return std::sqrt(sum / double(a.positions.size()));
}

/// The errors halve with the step: both are methods of first order.
template <class Dynamics>
void check_first_order(Dynamics& dynamics, const OrganModel& model, int coarsest) {
  std::vector<Result> results;
  results.reserve(5);
  for (int k = 0; k < 5; ++k) results.push_back(let_go(dynamics, model, coarsest << k));
  for (std::size_t k = 1; k + 1 < results.size(); ++k) {
    const double ratio =
        distance(results[k - 1], results[k]) / distance(results[k], results[k + 1]);
    const double energy_ratio =
        (results[k - 1].energy - results[k].energy) / (results[k].energy - results[k + 1].energy);
    UNSCOPED_INFO(coarsest << " << " << k << ": " << distance(results[k - 1], results[k]) << " m, "
                           << "ratio " << ratio << ", of the energy " << energy_ratio);
    CHECK(std::log2(ratio) == Approx(1).margin(0.2));
  }
}

TEST_CASE("step halving: symplectic Euler is of first order in the trajectory") {
  // Oracle: the order of the method. 0.2: what is left of the next order.
  auto organ = testing::ball_organ();
  const auto model = testing::ball_model(2, organ);
  SymplecticEuler dynamics(model);
  check_first_order(dynamics, model, 200);
}

TEST_CASE("step halving: backward Euler is of first order in the trajectory") {
  // Oracle: the order of the method, with the linear system solved to the end.
  auto organ = testing::ball_organ();
  const auto model = testing::ball_model(2, organ);
  BackwardEuler dynamics(model, 100);
  check_first_order(dynamics, model, 200);
}

TEST_CASE("step halving: symplectic Euler's energy swings with the step but does not drift") {
  // Oracle: a symplectic method keeps a Hamiltonian near by: half the step, half the swing; no
  // trend over 500 swings. Undamped springs, no volume constraint.
  auto organ = testing::ball_organ();
  organ.model = scene::Model::kMassSpring;
  organ.tissue.drag = organ.tissue.damping_ratio = 0;
  const auto model = testing::ball_model(1, organ);
  double last_swing = 0;
  for (const double fraction : {0.4, 0.2, 0.1}) {
    SymplecticEuler dynamics(model);
    const double h = fraction * dynamics.largest_step();
    OrganState state = rest_state(model);
    for (Vec3& p : state.positions) p = Vec3(1.02 * p.x(), p.y(), p.z() / 1.02);
    const double begin = dynamics.elastic_energy(state);
    double low[2] = {1e300, 1e300}, high[2] = {0, 0};
    const int steps = static_cast<int>(10'000 / fraction);
    for (int s = 0; s < steps; ++s) {
      dynamics.step(h, {}, state);
      double energy = dynamics.elastic_energy(state);
      for (std::size_t i = 0; i < model.node_count(); ++i) {
        energy += model.masses[i] * state.velocities[i].squaredNorm() / 2;
      }
      const int half = s < steps / 2 ? 0 : 1;
      low[half] = std::min(low[half], energy / begin);
      high[half] = std::max(high[half], energy / begin);
    }
    const double swing = high[1] - low[1];
    UNSCOPED_INFO(fraction << ": " << low[0] << " … " << high[0] << ", then " << low[1] << " … "
                           << high[1]);
    CHECK(std::abs(high[1] + low[1] - high[0] - low[0]) < swing);
    if (last_swing > 0) CHECK(last_swing / swing == Approx(2).margin(1));
    last_swing = swing;
  }
}

}  // namespace
}  // namespace palpate::deformation
