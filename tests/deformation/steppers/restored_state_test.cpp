// All that influences the steps to come is in the state.
#include <catch2/catch.hpp>

#include "modules/scene/models.h"
#include "modules/scene/schema.h"
#include "squeeze.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

constexpr double kRestoredStep = 5e-4;  // [s]

/// A state and the impulses its contacts start from.
struct Moment {
  OrganState state;
  std::vector<ContactRow> rows;
};

/// Presses the organ's top with a rough plate, tilted and oblique so that no two nodes are alike.
/// @param from  steps done before
void press(OrganDynamics& dynamics, double top, int from, int steps, Moment& now) {
  const Vec3 normal = Vec3(0.02, -0.01, 1).normalized(), velocity(0.03, 0.01, -0.1);
  for (int k = from; k < from + steps; ++k) {
    const Vec3 plate = Vec3(0, 0, top + 1e-3) + k * kRestoredStep * velocity;
    for (ContactRow& row : now.rows) {
      row.normal = normal;
      row.gap = normal.dot(plate - now.state.positions[row.nodes[0]]);
      row.probe_velocity = velocity;
      row.friction = 0.3;
    }
    dynamics.step(std::min(kRestoredStep, dynamics.largest_step()), now.rows, now.state);
  }
}

double top_of(const OrganModel& model) {
  double top = -1;
  for (const Vec3& p : model.rest_positions) top = std::max(top, p.z());
  return top;
}

Moment start(const OrganModel& model) {
  Moment now{rest_state(model), {}};
  for (std::uint32_t i = 0; i < model.surface_node_count; ++i) {
    if (now.state.positions[i].z() < 0.97 * top_of(model)) continue;
    now.rows.emplace_back();
    now.rows.back().nodes = {i, i, i};
    now.rows.back().weights = Vec3::UnitX();
  }
  return now;
}

/// A block of a solid, a ball of springs; by each integrator that the model leaves a choice of.
std::vector<scene::Organ> organs_of_all_models() {
  std::vector<scene::Organ> organs;
  for (const ModelRow& row : model_rows()) {
    const scene::ModelFormat& format = scene::format_of(row.word);
    organs.push_back(format.is_solid() ? testing::reference_ball(row.word) : testing::ball_organ());
    organs.back().model = row.word;
    if (!format.has_integrator) continue;
    organs.back().integrator = scene::Integrator::kSymplecticEuler;
    organs.push_back(organs.back());
    organs.back().integrator = scene::Integrator::kBackwardEuler;
  }
  return organs;
}

void check_same_bits(const OrganState& a, const OrganState& b) {
  CHECK(a.positions == b.positions);
  CHECK(a.velocities == b.velocities);
  CHECK(a.pressure == b.pressure);
}

TEST_CASE("restored state: continues as if it had never been left") {
  // Oracle: the steps that follow without a pause, bit by bit; by the stepper that went elsewhere
  // meanwhile, and by one that never saw the organ.
  for (const scene::Organ& organ : organs_of_all_models()) {
    CAPTURE(organ.model, scene::word_of(organ.integrator));
    const auto model = scene::is_solid(organ.model) ? testing::block_model(organ, 2)
                                                    : testing::ball_model(2, organ);
    const double top = top_of(model);
    const auto dynamics = make_dynamics(organ, model, kRestoredStep);
    Moment straight = start(model);
    press(*dynamics, top, 0, 25, straight);
    const Moment kept = straight;
    press(*dynamics, top, 25, 25, straight);
    double force = 0;
    for (const ContactRow& row : straight.rows) force += row.normal_impulse / kRestoredStep;
    REQUIRE(force > 0);

    Moment again = kept;
    press(*dynamics, top, 25, 25, again);
    check_same_bits(again.state, straight.state);
    CHECK(dynamics->elastic_energy(again.state) == dynamics->elastic_energy(straight.state));

    Moment elsewhere = kept;
    const auto fresh = make_dynamics(organ, model, kRestoredStep);
    press(*fresh, top, 25, 25, elsewhere);
    check_same_bits(elsewhere.state, straight.state);
  }
}

}  // namespace
}  // namespace palpate::deformation
