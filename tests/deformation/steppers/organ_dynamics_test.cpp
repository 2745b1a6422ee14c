#include "deformation/models.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "deformation/steppers/xpbd_springs.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

using testing::kPeriod;

TEST_CASE("organ dynamics: its largest step is below the stable bound and stays sound") {
  // Oracle: stable_step_bound(), tested against eigenvalues in organ_model_test.
  const auto organ = testing::ball_organ();
  const auto model = testing::ball_model(2, organ);
  const auto dynamics = make_dynamics(organ, model, kPeriod);
  CHECK(dynamics->largest_step() > 0.5 * stable_step_bound(model));
  CHECK(dynamics->largest_step() < stable_step_bound(model));
}

TEST_CASE("organ dynamics: automatic steps implicitly where that saves passes over the springs") {
  // Oracle: the counts printed with the choice, and the rule.
  auto organ = testing::ball_organ();
  const auto choose = [&](double youngs_modulus, double period) {
    organ.tissue.youngs_modulus = youngs_modulus;
    return choose_integrator(organ, testing::ball_model(2, organ), period);
  };
  const auto soft = choose(10e3, 0.1), stiff = choose(10e6, 0.1);
  CHECK(soft.integrator == scene::Integrator::kSymplecticEuler);
  CHECK(stiff.integrator == scene::Integrator::kBackwardEuler);
  CHECK(stiff.symplectic_passes > 2 * stiff.backward_passes);
  // Explicit passes go with √E, implicit ones with the period alone.
  CHECK(stiff.symplectic_passes == Approx(std::sqrt(1000) * soft.symplectic_passes).epsilon(0.2));
  CHECK(stiff.backward_passes == soft.backward_passes);
  CHECK(choose(10e6, 1e-4).integrator == scene::Integrator::kSymplecticEuler);
}

TEST_CASE("organ dynamics: the scene's word for the integrator counts") {
  // Oracle: the largest step, which tells them apart.
  auto organ = testing::ball_organ();
  const auto model = testing::ball_model(2, organ);
  organ.integrator = scene::Integrator::kBackwardEuler;
  CHECK(make_dynamics(organ, model, kPeriod)->largest_step() > stable_step_bound(model));
  organ.integrator = scene::Integrator::kSymplecticEuler;
  CHECK(make_dynamics(organ, model, kPeriod)->largest_step() < stable_step_bound(model));
}

TEST_CASE("organ dynamics: the scene's number of iterations counts, 0 is the model's own") {
  // Oracle: the same model made by hand.
  auto organ = testing::ball_organ();
  organ.model = "xpbd_springs";
  const auto model = testing::ball_model(2, organ);
  const auto after = [&](OrganDynamics& dynamics) {
    OrganState state = rest_state(model);
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      state.velocities[i] = Vec3(state.positions[i].y(), 0, 0);
    }
    dynamics.step(XpbdSprings::kStep, {}, state);
    return state.positions;
  };
  for (const std::size_t iterations : {std::size_t{0}, std::size_t{3}}) {
    organ.iterations = iterations;
    XpbdSprings wanted(model, iterations == 0 ? 1 : 3);
    CHECK(after(*make_dynamics(organ, model, kPeriod)) == after(wanted));
  }
}

}  // namespace
}  // namespace palpate::deformation
