#include "deformation/models.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "deformation/steppers/xpbd_springs.h"
#include "tests/deformation/organs.h"
#include "tests/deformation/springs/chunk_threads.h"
#include "tests/deformation/steppers/tetrahedral_solids.h"

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

/// Where an organ that swings and is pressed at one triangle is after some steps, and the impulse
/// in all.
std::pair<OrganState, double> pressed_by_hand(const scene::Organ& organ, const OrganModel& model,
                                              ChunkRunner* runner) {
  const auto dynamics = make_dynamics(organ, model, kPeriod, runner);
  OrganState state = rest_state(model);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    if (model.inverse_masses[i] == 0) continue;
    state.velocities[i] = Vec3(state.positions[i].y(), 0.2 * state.positions[i].x(), 0);
  }
  ContactRow row;
  row.nodes = model.triangles[5];
  row.weights = Vec3(0.5, 0.3, 0.2);
  const auto& x = state.positions;
  row.normal = (x[row.nodes[1]] - x[row.nodes[0]]).cross(x[row.nodes[2]] - x[row.nodes[0]]);
  row.normal.normalize();
  row.friction = 0.3;
  row.gap = -2e-3;
  const double h = std::min(kPeriod, dynamics->largest_step());
  double impulse = 0;
  for (int k = 0; k < 3; ++k) {
    dynamics->step(h, std::span(&row, 1), state);
    impulse += row.normal_impulse;
  }
  return {state, impulse};
}

TEST_CASE("organ dynamics: the same bits on any number of threads, of springs and of solids") {
  // Oracle: itself on one thread. Meshes of several chunks, ranges and parts.
  auto organ = testing::ball_organ();
  OrganModel model;
  SECTION("symplectic Euler") {
    organ.integrator = scene::Integrator::kSymplecticEuler;
    model = testing::ball_model(4, organ);
  }
  SECTION("backward Euler") {
    organ.integrator = scene::Integrator::kBackwardEuler;
    organ.volume_corrections = 1;
    model = testing::ball_model(4, organ);
  }
  SECTION("corotational") {
    organ = testing::solid_organ("corotational", 0.4);
    model = testing::cube_model(organ, Vec3::Zero(), 9);
  }
  SECTION("nodal pressure") {
    organ = testing::solid_organ("nodal_pressure", 0.49);
    model = testing::cube_model(organ, Vec3::Zero(), 9);
  }
  const auto [alone, impulse] = pressed_by_hand(organ, model, nullptr);
  CHECK(impulse > 0);
  for (const std::size_t count : {2u, 3u}) {
    testing::ChunkThreads threads(count);
    const auto [shared, same_impulse] = pressed_by_hand(organ, model, &threads);
    CHECK(shared.positions == alone.positions);
    CHECK(shared.velocities == alone.velocities);
    CHECK(shared.pressure == alone.pressure);
    CHECK(same_impulse == impulse);
  }
}

TEST_CASE("organ dynamics: springs that keep a volume tell it as the plain code finds it") {
  // Oracle: evaluate_volume(), in double as this is; before the first step and between two.
  auto organ = testing::ball_organ();
  organ.integrator =
      GENERATE(scene::Integrator::kSymplecticEuler, scene::Integrator::kBackwardEuler);
  const auto model = testing::ball_model(3, organ);
  const auto dynamics = make_dynamics(organ, model, kPeriod);
  OrganState state = rest_state(model);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    state.velocities[i] = Vec3(state.positions[i].y(), 0, 0);
  }
  for (int step = 0; step < 2; ++step) {
    const VolumeGradient* const found = dynamics->volume_at(state.positions);
    REQUIRE(found != nullptr);
    VolumeGradient plain;
    evaluate_volume(model, state.positions, plain);
    CHECK(found->volume == Approx(plain.volume).epsilon(1e-13));
    CHECK(found->denominator == Approx(plain.denominator).epsilon(1e-12));
    REQUIRE(found->gradient.size() == plain.gradient.size());
    for (std::size_t i = 0; i < plain.gradient.size(); ++i) {
      REQUIRE((found->gradient[i] - plain.gradient[i]).norm() < 1e-12 * plain.gradient[i].norm());
    }
    dynamics->step(dynamics->largest_step(), {}, state);
  }
  organ.model = "mass_spring";
  const auto leaky = testing::ball_model(3, organ);
  CHECK(make_dynamics(organ, leaky, kPeriod)->volume_at(leaky.rest_positions) == nullptr);
}

}  // namespace
}  // namespace palpate::deformation
