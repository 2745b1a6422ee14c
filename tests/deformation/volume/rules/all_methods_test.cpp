// What holds for every neighbour method, made as a scene makes it.
#include <catch2/catch.hpp>

#include "method_checks.h"
#include "modules/core/error.h"
#include "modules/scene/models.h"
#include "modules/scene/schema.h"

namespace palpate::deformation {
namespace {

using testing::momentum;

constexpr double kRuleStep = 1e-3;

/// Those of springs that step by symplectic Euler, and ChainMail.
std::vector<std::string> all_models() {
  std::vector<std::string> models;
  for (const scene::ModelFormat& format : scene::model_formats()) {
    if (!format.is_solid() && format.iterations == 0) models.emplace_back(format.word);
  }
  return models;
}

Vec3 angular_momentum(const OrganModel& model, const OrganState& state) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    sum += model.masses[i] * state.positions[i].cross(state.velocities[i]);
  }
  return sum;
}

TEST_CASE("neighbours: every model of the scene can be stepped, with its own largest step") {
  // Oracle: none stays far below or above what the springs allow.
  for (const std::string& method : all_models()) {
    INFO(method);
    const auto organ = testing::ball_organ_with(method);
    const auto model = testing::ball_model(2, organ);
    const auto dynamics = make_dynamics(organ, model, kRuleStep);
    CHECK(dynamics->largest_step() > 0.1 * stable_step_bound(model));
    CHECK(dynamics->largest_step() < stable_step_bound(model));
    OrganState state = rest_state(model);
    CHECK_FALSE(dynamics->step(kRuleStep, {}, state).volume_skipped);
    CHECK(testing::volume_of(model, state) == Approx(model.rest_volume).epsilon(1e-9));
  }
}

TEST_CASE("neighbours: a free organ keeps its momentum") {
  // Oracle: no outer force. All but ChainMail have momentum; those that project positions keep the
  // linear one only (their headers say so). Sums of a node's springs are rounded in float: 6e-8 of
  // what is exchanged, at random; so is the volume's gradient, which turns the organ: 6e-8 of a
  // node's stiffness times the amplitude, over all nodes and steps.
  for (const std::string& method : all_models()) {
    if (method == "chainmail") continue;
    INFO(method);
    const auto organ = testing::undamped_ball_with(method);
    const auto model = testing::ball_model(1, organ);
    const auto dynamics = make_dynamics(organ, model, kRuleStep);
    OrganState state = testing::shaken_state(model, 1e-3, 0.1);
    const Vec3 linear = momentum(model, state), angular = angular_momentum(model, state);
    for (int s = 0; s < 200; ++s) dynamics->step(kRuleStep, {}, state);
    const double scale = model.masses[0] * static_cast<double>(model.node_count()) * 0.1;
    CHECK((momentum(model, state) - linear).norm() < 1e-8 * scale);
    const bool projects = method == "promayon" || method == "post_stabilisation";
    if (projects) continue;
    const double stiffness = *std::ranges::max_element(model.node_stiffness);
    const double rounding = 6e-8 * stiffness * 1e-3 * kRuleStep *
                            std::sqrt(200.0 * static_cast<double>(model.node_count()));
    CHECK((angular_momentum(model, state) - angular).norm() < 3 * rounding * testing::kBallRadius);
  }
}

TEST_CASE("neighbours: fixed nodes never move") {
  // Oracle: invariant.
  for (const std::string& method : all_models()) {
    INFO(method);
    auto organ = testing::ball_organ_with(method);
    organ.fixed.push_back(scene::SphereRegion{Vec3(0, 0, 0.05), 0.03});
    const auto model = testing::ball_model(2, organ);
    const auto dynamics = make_dynamics(organ, model, kRuleStep);
    OrganState state = testing::shaken_state(model, 1e-3, 0.1);
    for (int s = 0; s < 50; ++s) dynamics->step(kRuleStep, {}, state);
    for (const auto node : model.fixed_nodes) {
      CHECK(state.positions[node] == model.rest_positions[node]);
    }
  }
}

TEST_CASE("neighbours: a flattened ball stays finite") {
  // Oracle: invariant. All nodes in one plane: volume 0 and gᵀM⁻¹g small or none.
  for (const std::string& method : all_models()) {
    INFO(method);
    const auto organ = testing::ball_organ_with(method);
    const auto model = testing::ball_model(2, organ);
    const auto dynamics = make_dynamics(organ, model, kRuleStep);
    for (const Vec3& keep : {Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, 0)}) {
      OrganState state = rest_state(model);
      for (Vec3& x : state.positions) x = x.cwiseProduct(keep);
      for (int s = 0; s < 20; ++s) dynamics->step(kRuleStep, {}, state);
      for (const Vec3& x : state.positions) REQUIRE(x.allFinite());
      for (const Vec3& v : state.velocities) REQUIRE(v.allFinite());
      CHECK(std::isfinite(state.pressure));
    }
  }
}

TEST_CASE("neighbours: what does not go together is refused by name") {
  // Oracle: the schema's words in the message.
  auto organ = testing::ball_organ_with("zordan");
  organ.springs.virtual_nodes = 0;
  const auto hollow = testing::ball_model(1, organ);
  CHECK_THROWS_WITH(make_dynamics(organ, hollow, kRuleStep),
                    Catch::Contains("organ 'ball'") && Catch::Contains("model zordan") &&
                        Catch::Contains("virtual_nodes must be at least 1"));
  organ.model = "element_volume";
  CHECK_THROWS_AS(make_dynamics(organ, hollow, kRuleStep), InputError);
  organ.model = "penalty";
  CHECK_NOTHROW(make_dynamics(organ, hollow, kRuleStep));
  organ.integrator = scene::Integrator::kBackwardEuler;
  CHECK_THROWS_WITH(make_dynamics(organ, hollow, kRuleStep),
                    Catch::Contains("model penalty") && Catch::Contains("integrator must be"));
}

}  // namespace
}  // namespace palpate::deformation
