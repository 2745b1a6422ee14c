#include "deformation/models.h"

#include <catch2/catch.hpp>
#include <set>

#include "modules/scene/models.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

constexpr double kPeriod = 4e-3;  // [s]

/// A coarse ball of the model, a little out of shape and moving.
struct Moving {
  OrganModel model;
  std::unique_ptr<OrganDynamics> dynamics;
  OrganState state;

  explicit Moving(scene::Organ organ)
      : model(testing::ball_model(1, organ, Vec3(0, 0, -1))),
        dynamics(make_dynamics(organ, model, kPeriod)),
        state(rest_state(model)) {
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      state.velocities[i] = Vec3(4 * state.positions[i].y(), 0, -3 * state.positions[i].x());
    }
  }

  /// @param rows  of the contacts; their impulses are where the next steps begin
  void advance(int steps, std::vector<ContactRow>& rows, OrganState& from) {
    for (int s = 0; s < steps; ++s) dynamics->step(1e-3, rows, from);
  }
};

std::vector<ContactRow> pressing_row(const OrganModel& model) {
  ContactRow row;
  row.nodes = model.triangles[0];
  row.weights = Vec3(0.2, 0.3, 0.5);
  row.normal = Vec3(0.6, 0, 0.8);
  row.gap = -1e-4;
  row.friction = 0.3;
  return {row};
}

/// A ball of each model of springs, by each integrator.
std::vector<scene::Organ> balls_of_springs() {
  std::vector<scene::Organ> organs;
  for (const ModelRow& row : model_rows()) {
    const scene::ModelFormat& format = scene::format_of(row.word);
    if (format.is_solid()) continue;
    auto organ = testing::ball_organ();
    organ.model = row.word;
    organ.integrator = scene::Integrator::kSymplecticEuler;
    organs.push_back(organ);
    if (!format.has_integrator) organs.back().integrator = scene::Integrator::kAutomatic;
    if (!format.has_integrator) continue;
    organ.integrator = scene::Integrator::kBackwardEuler;
    organs.push_back(organ);
  }
  return organs;
}

TEST_CASE("models: deformation and scene have a row each for the same words") {
  // Oracle: the other table.
  std::set<std::string_view> ours, theirs;
  for (const ModelRow& row : model_rows()) CHECK(ours.insert(row.word).second);
  for (const scene::ModelFormat& format : scene::model_formats()) theirs.insert(format.word);
  CHECK(ours == theirs);
  for (const ModelRow& row : model_rows()) CHECK(row.make != nullptr);
}

TEST_CASE("models: the state holds all that a step depends on, to the last bit") {
  // Oracle: itself. 50 steps; 25, then 25 from a copy of the state, twice on the same stepper.
  for (const scene::Organ& organ : balls_of_springs()) {
    INFO(organ.model << " " << int(organ.integrator));
    Moving straight(organ), copied(organ);
    auto rows = pressing_row(straight.model);
    straight.advance(50, rows, straight.state);
    auto first = pressing_row(copied.model);
    copied.advance(25, first, copied.state);
    const OrganState kept = copied.state;
    const auto kept_rows = first;
    for (int again = 0; again < 2; ++again) {
      OrganState state = kept;
      auto second = kept_rows;
      copied.advance(25, second, state);
      CHECK(state.positions == straight.state.positions);
      CHECK(state.velocities == straight.state.velocities);
      CHECK(state.pressure == straight.state.pressure);
    }
  }
}

TEST_CASE("models: those that conserve volume or momentum do") {
  // Oracle: invariants, without contacts and gravity. 1e-3 of V₀: steps of 1 ms leave what their
  // linearisation leaves. Momentum: floats of the springs.
  for (const ModelRow& row : model_rows()) {
    if (scene::is_solid(row.word)) continue;
    auto organ = testing::ball_organ();
    organ.model = row.word;
    organ.tissue.drag = 0;
    const auto model = testing::ball_model(2, organ);
    const auto dynamics = make_dynamics(organ, model, kPeriod);
    OrganState state = rest_state(model);
    double size = 0;
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      state.velocities[i] = Vec3(2 * state.positions[i].y(), 0, -1 * state.positions[i].x());
      size += model.masses[i] * state.velocities[i].norm();
    }
    for (int s = 0; s < 100; ++s) dynamics->step(1e-3, {}, state);
    Vec3 momentum = Vec3::Zero();
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      momentum += model.masses[i] * state.velocities[i];
    }
    INFO(row.word);
    const double volume = geometry::enclosed_volume(state.positions, model.triangles);
    if (row.conserves_volume) CHECK(std::abs(volume / model.rest_volume - 1) < 1e-3);
    if (row.conserves_momentum) CHECK(momentum.norm() < 1e-5 * size);
  }
}

}  // namespace
}  // namespace palpate::deformation
