#include "deformation/volume/rules/explicit_step.h"

#include <catch2/catch.hpp>

#include "method_checks.h"

namespace palpate::deformation {
namespace {

TEST_CASE("explicit step: without forces of its own a method takes the springs' step") {
  // Oracle: stable_step_bound(), tested against eigenvalues, and the safety factor.
  const auto model = testing::ball_model(2);
  CHECK(largest_explicit_step(model, 0) == Approx(0.9 * stable_step_bound(model)).epsilon(1e-12));
}

TEST_CASE("explicit step: added stiffness shortens the step to 2/√(sum of squared frequencies)") {
  // Oracle: analytic, undamped symplectic Euler.
  const auto model = testing::ball_model(2, testing::undamped_ball_with("mass_spring"));
  const double squared = highest_squared_frequency_bound(model);
  for (const double added : {0.1 * squared, squared, 50 * squared}) {
    CHECK(largest_explicit_step(model, added) ==
          Approx(0.9 * 2 / std::sqrt(squared + added)).epsilon(1e-9));
  }
}

TEST_CASE("explicit step: along the gradient, fixed nodes stay and the rest moves by g/m") {
  // Oracle: the formula, by hand.
  auto organ = testing::ball_organ();
  organ.fixed.push_back(scene::SphereRegion{Vec3(0, 0, 0.05), 0.03});
  const auto model = testing::ball_model(1, organ);
  VolumeGradient volume;
  evaluate_volume(model, model.rest_positions, volume);
  auto moved = model.rest_positions;
  add_along_gradient(model, volume.gradient, 2, moved);
  for (std::size_t i = 0; i < model.surface_node_count; ++i) {
    const Vec3 expected = model.inverse_masses[i] == 0
                              ? Vec3::Zero()
                              : Vec3(2 / model.masses[i] * volume.gradient[i]);
    CHECK((moved[i] - model.rest_positions[i] - expected).norm() < 1e-12);
  }
}

TEST_CASE("explicit step: the gradient has vanished on a flattened ball, not at rest") {
  // Oracle: all triangles in one plane turned both ways have g = 0.
  const auto model = testing::ball_model(1);
  auto positions = model.rest_positions;
  VolumeGradient volume;
  evaluate_volume(model, positions, volume);
  CHECK_FALSE(has_vanished(model, volume));
  for (Vec3& x : positions) x *= 1e-5;
  evaluate_volume(model, positions, volume);
  CHECK(has_vanished(model, volume));
}

}  // namespace
}  // namespace palpate::deformation
