#include "deformation/steppers/chainmail.h"

#include "tests/deformation/analytic/plates.h"
#include "tests/deformation/volume/rules/method_checks.h"

namespace palpate::deformation {
namespace {

/// Presses the topmost node down to `height` [m] as a fixed probe would.
std::vector<ContactRow> press_top(const OrganModel& model, const OrganState& state, double height) {
  std::uint32_t top = 0;
  for (std::uint32_t i = 0; i < model.surface_node_count; ++i) {
    if (model.rest_positions[i].z() > model.rest_positions[top].z()) top = i;
  }
  ContactRow row;
  row.nodes = {top, top, top};
  row.weights = Vec3::UnitX();
  row.gap = height - state.positions[top].z();
  return {row};
}

/// How far the worst link is out of its bounds, of its rest length.
double worst_link(const ChainMail& chain, const OrganState& state) {
  double worst = 0;
  for (const auto& link : chain.links()) {
    const double length = (state.positions[link.node_b] - state.positions[link.node_a]).norm();
    worst = std::max({worst, length / link.rest_length - ChainMail::kLongest,
                      ChainMail::kShortest - length / link.rest_length});
  }
  return worst;
}

TEST_CASE("ChainMail: an untouched organ stays where it is, to the last bit") {
  // Oracle: invariant.
  const auto model = testing::ball_model(2, testing::ball_organ(), Vec3(0, 0, -9.81));
  ChainMail chain(model);
  OrganState state = rest_state(model);
  for (int s = 0; s < 10; ++s) chain.step(1e-3, {}, state);
  CHECK(state.positions == model.rest_positions);
}

TEST_CASE("ChainMail: links keep their bounds while a node is pushed in by half the radius") {
  // Oracle: the definition, to the tolerance of its sweeps.
  const auto model = testing::ball_model(3);
  ChainMail chain(model);
  OrganState state = rest_state(model);
  for (int s = 1; s <= 100; ++s) {
    const double height = testing::kBallRadius * (1 - 0.005 * s);
    auto rows = press_top(model, state, height);
    chain.step(1e-3, rows, state);
    REQUIRE(worst_link(chain, state) <= 2 * ChainMail::kBoundTolerance);
    CHECK(rows[0].normal_impulse > 0);
  }
}

TEST_CASE("ChainMail: a push within the slack of the links moves nothing else in that step") {
  // Oracle: Gibson's rule: a neighbour moves only if its link would leave its bounds.
  const auto model = testing::ball_model(2);
  ChainMail chain(model);
  OrganState state = rest_state(model);
  auto rows = press_top(model, state, testing::kBallRadius - 1e-3);
  chain.step(1e-3, rows, state);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    moved += state.positions[i] != model.rest_positions[i];
  }
  CHECK(moved == 1);
}

TEST_CASE("ChainMail: within its bounds it settles to the springs' shape and their force") {
  // Oracle: plain mass-spring between the same plates, which has the same equilibrium; 1 % is what
  // is left of the relaxation.
  auto organ = testing::ball_organ_with("mass_spring");
  organ.tissue.drag = 10;
  const auto model = testing::ball_model(1, organ);
  ChainMail chain(model);
  auto springs = testing::springs_alone(model);
  double forces[2];
  OrganDynamics* const both[] = {&chain, &springs};
  for (int k = 0; k < 2; ++k) {
    OrganState state = rest_state(model);
    testing::Plates plates(model, testing::kBallRadius);
    testing::squeeze(model, *both[k], 1e-3, 0.05, 0.5, 4, plates, state);
    forces[k] = plates.force();
  }
  REQUIRE(forces[1] > 1e-3);
  CHECK(forces[0] == Approx(forces[1]).epsilon(0.01));
}

TEST_CASE("ChainMail: a probe that appears deep inside pushes no faster than it moves and 1 m/s") {
  // Oracle: kMaxSeparationSpeed, as in contact_solve.h.
  const auto model = testing::ball_model(2);
  ChainMail chain(model);
  OrganState state = rest_state(model);
  auto rows = press_top(model, state, 0);
  rows[0].probe_velocity = -0.2 * rows[0].normal;
  const auto top = rows[0].nodes[0];
  const double height = state.positions[top].z();
  chain.step(1e-3, rows, state);
  CHECK(height - state.positions[top].z() == Approx(1e-3 * (kMaxSeparationSpeed + 0.2)));
}

TEST_CASE("ChainMail: fixed nodes hold the chain") {
  // Oracle: invariant.
  auto organ = testing::ball_organ();
  organ.fixed.push_back(scene::SphereRegion{Vec3(0, 0, -0.05), 0.02});
  const auto model = testing::ball_model(2, organ);
  ChainMail chain(model);
  OrganState state = rest_state(model);
  for (int s = 1; s <= 50; ++s) {
    auto rows = press_top(model, state, testing::kBallRadius * (1 - 0.01 * s));
    chain.step(1e-3, rows, state);
  }
  for (const auto node : model.fixed_nodes) {
    CHECK(state.positions[node] == model.rest_positions[node]);
  }
}

}  // namespace
}  // namespace palpate::deformation
