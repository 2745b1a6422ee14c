#include "deformation/springs/kernel/spring_gauss_seidel.h"

#include <catch2/catch.hpp>
#include <random>
#include <set>

#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

OrganModel held_ball() {
  auto organ = testing::ball_organ();
  organ.model = "xpbd_springs";
  organ.fixed.push_back(scene::SphereRegion{Vec3(0, 0, 0.05), 0.03});
  return testing::ball_model(2, organ);
}

/// All springs of a batch, those of padding left out.
template <class Act>
void for_springs(const SpringGaussSeidel& visits, std::size_t node_count, Act act) {
  for (const auto& batch : visits.batches()) {
    for (std::size_t lane = 0; lane < kernel::kVisitLanes; ++lane) {
      const std::size_t a = batch.nodes_a[lane] / kernel::kVisitedDoubles;
      const std::size_t b = batch.nodes_b[lane] / kernel::kVisitedDoubles;
      if (a < node_count) act(batch, lane, a, b);
    }
  }
}

TEST_CASE("spring visits: every spring that can move a node once, four at a time apart") {
  // Oracle: the network.
  const OrganModel model = held_ball();
  const SpringGaussSeidel visits(model, model.network());
  std::multiset<std::pair<std::size_t, std::size_t>> visited, wanted;
  for_springs(visits, model.node_count(), [&](const auto&, std::size_t, auto a, auto b) {
    visited.insert({a, b});
  });
  for (const Spring& spring : model.network().springs) {
    if (model.inverse_masses[spring.node_a] + model.inverse_masses[spring.node_b] > 0) {
      wanted.insert({spring.node_a, spring.node_b});
    }
  }
  CHECK(wanted.size() < model.network().springs.size());
  CHECK(visited == wanted);
  for (const auto& batch : visits.batches()) {
    std::multiset<std::uint32_t> nodes(std::begin(batch.nodes_a), std::end(batch.nodes_a));
    nodes.insert(std::begin(batch.nodes_b), std::end(batch.nodes_b));
    for (const std::uint32_t node : nodes) {
      CHECK((nodes.count(node) == 1 || node == kernel::kVisitedDoubles * model.node_count()));
    }
  }
}

/// xpbd_springs.h, spring by spring.
void relax_plainly(const OrganModel& model, const SpringGaussSeidel& visits, double h, int passes,
                   const std::vector<Vec3>& start, std::vector<Vec3>& x) {
  std::vector<double> multipliers;
  for (int k = 0; k < passes; ++k) {
    std::size_t s = 0;
    for_springs(
        visits, model.node_count(), [&](const auto& batch, std::size_t lane, auto a, auto b) {
          if (k == 0) multipliers.push_back(0);
          const double w_a = model.inverse_masses[a], w_b = model.inverse_masses[b];
          const double alpha = batch.flexibilities[lane] / (h * h);
          const double gamma = batch.damping_times[lane] / h;
          const Vec3 arm = x[b] - x[a], u = arm.normalized();
          const double closing = u.dot(arm - (start[b] - start[a]));
          const double change =
              -(arm.norm() - batch.rest_lengths[lane] + gamma * closing + alpha * multipliers[s]) /
              ((1 + gamma) * (w_a + w_b) + alpha);
          multipliers[s++] += change;
          x[a] -= w_a * change * u;
          x[b] += w_b * change * u;
        });
  }
}

TEST_CASE("spring visits: the plain formula to rounding, the same bits by every instruction set") {
  // Oracle: the formula, one spring after another in the same order. Some 10 roundings of 1e-16 of
  // 5 cm in each of about 20 visits of a node.
  const OrganModel model = held_ball();
  constexpr double kStep = 4e-3;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> noise(-0.5, 0.5);
  const auto start = rest_state(model).positions;
  std::vector<Vec3> began(model.node_count(), Vec3::Zero()), moved = start;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    if (model.inverse_masses[i] > 0) began[i] = Vec3(noise(random), noise(random), noise(random));
    moved[i] += kStep * began[i];
  }
  for (const InstructionSet set : available_instruction_sets()) {
    for (const int passes : {1, 3}) {
      INFO(name_of(set) << ", " << passes << " passes");
      SpringGaussSeidel visits(model, model.network(), set),
          portable(model, model.network(), InstructionSet::kPortable);
      auto velocities = began, plain = moved;
      std::vector<Vec3> fast, same;
      visits.relax(kStep, passes, start, velocities, fast);
      relax_plainly(model, visits, kStep, passes, start, plain);
      double largest = 0, way = 0;
      for (std::size_t i = 0; i < model.node_count(); ++i) {
        largest = std::max(largest, (fast[i] - plain[i]).norm());
        way = std::max(way, (plain[i] - moved[i]).norm());
        CHECK((start[i] + kStep * velocities[i] - fast[i]).norm() < 1e-16);
        if (model.inverse_masses[i] == 0) CHECK(fast[i] == start[i]);
      }
      CHECK(way > 5e-4);
      CHECK(largest < 1e-14);
      velocities = began;
      portable.relax(kStep, passes, start, velocities, same);
      CHECK(same == fast);
    }
  }
}

TEST_CASE("spring visits: a spring without length pulls at nothing") {
  // Oracle: the formula's limit; and that nothing is divided by zero.
  OrganModel model;
  model.rest_positions = {Vec3::Zero(), Vec3(0.01, 0, 0)};
  model.surface_node_count = 2;
  model.network().springs = {{0, 1, 0.01, 400}};
  model.masses = {0.002, 0.003};
  model.inverse_masses = {500, 1 / 0.003};
  model.network().damping = {0.05};
  const std::vector<Vec3> together(2, Vec3(0.02, 0.01, 0));
  for (const InstructionSet set : available_instruction_sets()) {
    std::vector<Vec3> positions, velocities(2, Vec3::Zero());
    SpringGaussSeidel(model, model.network(), set).relax(1e-3, 2, together, velocities, positions);
    CHECK(positions == together);
  }
}

}  // namespace
}  // namespace palpate::deformation
