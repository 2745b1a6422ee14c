// Energy of backward Euler between plates, down to the smallest steps.
#include <algorithm>
#include <catch2/catch.hpp>

#include "deformation/springs/spring_forces.h"
#include "deformation/steppers/backward_euler.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

using testing::ball_organ;
using testing::kBallRadius;

/// Rows of two plates at z = ± height with every node within 5 mm of them, without friction.
std::vector<ContactRow> rows_of_plates(const OrganModel& model, const OrganState& state,
                                       double height, std::vector<double>& impulses) {
  std::vector<ContactRow> rows;
  impulses.resize(2 * model.surface_node_count);
  for (std::uint32_t i = 0; i < impulses.size(); ++i) {
    const auto node = static_cast<std::uint32_t>(i / 2);
    const int side = i % 2 == 0 ? 1 : -1;
    ContactRow row;
    row.nodes = {node, node, node};
    row.weights = Vec3(1, 0, 0);
    row.normal = Vec3(0, 0, side);
    row.gap = height - side * state.positions[node].z();
    row.normal_impulse = impulses[i];
    if (row.gap < 5e-3) rows.push_back(row);
  }
  return rows;
}

/// Largest growth of kinetic and elastic energy in a step, as a part of the first, over 0.1 s of a
/// ball between plates that hold still.
double energy_grown_between_plates(scene::Organ organ, double squeeze, double h) {
  organ.tissue.drag = organ.tissue.damping_ratio = 0;
  const auto model = testing::ball_model(2, organ);
  BackwardEuler dynamics(model, {.is_kept = organ.model == "implicit_volume"});
  auto state = rest_state(model);
  const double height = (1 - squeeze) * kBallRadius;
  for (Vec3& x : state.positions) x.z() = std::clamp(x.z(), -height, height);
  state.target_volume = geometry::enclosed_volume(state.positions, model.triangles);
  const double first = dynamics.elastic_energy(state);
  std::vector<double> impulses;
  double before = first, grown = 0;
  for (int s = 0; s * h < 0.1; ++s) {
    auto rows = rows_of_plates(model, state, height, impulses);
    dynamics.step(h, rows, state);
    std::fill(impulses.begin(), impulses.end(), 0);
    for (const ContactRow& row : rows) {
      impulses[2 * row.nodes[0] + (row.normal.z() > 0 ? 0 : 1)] = row.normal_impulse;
    }
    const double energy = dynamics.elastic_energy(state) + kinetic_energy(model, state.velocities);
    grown = std::max(grown, energy - before);
    before = energy;
  }
  return grown / first;
}

TEST_CASE("backward Euler: plates that hold still give no energy, at any step") {
  // Oracle: invariant: a surface that does not move does no work, and backward Euler damps.
  auto organ = ball_organ();
  organ.model = GENERATE(as<std::string>{}, "mass_spring", "implicit_volume");
  for (const double squeeze : {0.1, 0.5, 0.8}) {
    for (const double h : {5e-5, 1e-4, 2.5e-4, 1e-3, 4e-3, 1e-2}) {
      INFO("squeeze " << squeeze << ", h " << h);
      CHECK(energy_grown_between_plates(organ, squeeze, h) < 1e-3);
    }
  }
}

}  // namespace
}  // namespace palpate::deformation
