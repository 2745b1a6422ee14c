#include "deformation/volume/rules/bourguignon_cani.h"

#include <catch2/catch.hpp>

#include "method_checks.h"

namespace palpate::deformation {
namespace {

TEST_CASE("Bourguignon-Cani: its forces are minus the gradient of its energy") {
  const auto model = testing::ball_model(2);
  auto method = testing::stepped_by<BourguignonCani>(model);
  auto state = testing::shaken_state(model, 3e-3, 0.1);
  testing::scale(state, 1.05);
  testing::check_forces_are_minus_gradient(
      model, method, state, [&](const OrganState& s) { return method.stored_energy(s); });
}

TEST_CASE("Bourguignon-Cani: a uniform inflation is answered by a penalty's pressure") {
  // Oracle: analytic, p = −K ΔV/V to first order: 1e-3 is the second.
  const auto model = testing::ball_model(2);
  auto method = testing::stepped_by<BourguignonCani>(model);
  OrganState state = rest_state(model);
  testing::scale(state, 1.0003);
  const double lost = 1 - testing::volume_of(model, state) / model.rest_volume;
  const auto forces = testing::method_forces(model, method, state);
  method.step(1e-6, {}, state);
  CHECK(state.pressure == Approx(BourguignonCani::kModulus * lost).epsilon(1e-3));
  // On the ball each node's force is that pressure on its area, up to how uneven the mesh is.
  for (std::size_t i = 0; i < model.surface_node_count; ++i) {
    CHECK(forces[i].norm() ==
          Approx(-state.pressure * model.network().node_areas[i]).epsilon(0.01));
  }
}

TEST_CASE("Bourguignon-Cani: it keeps a mean radius, so a flat ellipsoid has lost volume") {
  // Oracle: an ellipsoid (1+e, 1+e, 1−2e) of a ball has the ball's mean radius to first order and
  // the volume (1+e)²(1−2e) < 1.
  const auto model = testing::ball_model(2);
  const BourguignonCani method(model);
  auto positions = model.rest_positions;
  const double e = 0.01;
  for (Vec3& x : positions) x = Vec3((1 + e) * x.x(), (1 + e) * x.y(), (1 - 2 * e) * x.z());
  const double rest = method.mean_distance(model.rest_positions);
  CHECK(rest == Approx(testing::kBallRadius).epsilon(1e-3));
  CHECK(std::abs(method.mean_distance(positions) / rest - 1) < 2 * e * e);
}

}  // namespace
}  // namespace palpate::deformation
