#include "deformation/volume/rules/zordan.h"

#include <catch2/catch.hpp>

#include "method_checks.h"

namespace palpate::deformation {
namespace {

TEST_CASE("Zordan: its forces are minus the gradient of its energy") {
  const auto model = testing::ball_model(2);
  auto method = testing::stepped_by<Zordan>(model);
  const auto state = testing::shaken_state(model, 3e-3, 0.1);
  testing::check_forces_are_minus_gradient(
      model, method, state, [&](const OrganState& s) { return method.stored_energy(s); });
}

TEST_CASE("Zordan: a uniform inflation is answered by a penalty's pressure") {
  // Oracle: analytic, p = −K ΔV/V: area shares add up to one, so exact for any mesh.
  const auto model = testing::ball_model(2);
  auto method = testing::stepped_by<Zordan>(model);
  OrganState state = rest_state(model);
  testing::scale(state, 1.01);
  const double lost = 1 - testing::volume_of(model, state) / model.rest_volume;
  method.step(1e-6, {}, state);
  CHECK(state.pressure == Approx(Zordan::kModulus * lost).epsilon(1e-9));
}

TEST_CASE("Zordan: a local dent is answered where it is, unlike by a global pressure") {
  // Oracle: the definition. Triangles without a moved corner or apex have their volume and so no
  // pressure: nodes two rings from the dent and farther feel nothing, to the rounding of springs.
  const auto model = testing::ball_model(2);
  auto method = testing::stepped_by<Zordan>(model);
  OrganState state = rest_state(model);
  state.positions[0] *= 0.9;
  const auto forces = testing::method_forces(model, method, state);
  CHECK(forces[0].dot(model.rest_positions[0]) > 0);  // out again
  for (std::size_t i = 0; i < model.surface_node_count; ++i) {
    const double distance = (model.rest_positions[i] - model.rest_positions[0]).norm();
    if (distance > testing::kBallRadius) CHECK(forces[i].norm() < 1e-6 * forces[0].norm());
  }
}

}  // namespace
}  // namespace palpate::deformation
