#include "deformation/model/patch.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

TEST_CASE("patch: grows by rings, keeps to its size, leaves fixed nodes out") {
  // Oracle: definition; a ball's first ring is the neighbours of a node.
  scene::Organ organ = testing::ball_organ();
  organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.03)});
  const OrganModel model = testing::ball_model(2, organ);
  const Neighbours neighbours(model, {});
  Patch patch;
  const std::vector<std::uint32_t> touched{0};
  const auto ring = neighbours.of(0);
  grow_patch(model, neighbours, model.rest_positions, touched, model.rest_positions[0],
             1 + ring.size(), patch);
  CHECK(patch.nodes.size() == 1 + ring.size());
  CHECK(patch.place(0) == 0);
  for (const std::uint32_t node : ring) CHECK(patch.place(node) > 0);
  grow_patch(model, neighbours, model.rest_positions, touched, model.rest_positions[0], 3, patch);
  CHECK(patch.nodes.size() == 3);
  grow_patch(model, neighbours, model.rest_positions, touched, model.rest_positions[0], 10'000,
             patch);
  for (const std::uint32_t node : patch.nodes) CHECK(model.inverse_masses[node] > 0);
  CHECK(patch.nodes.size() == model.surface_node_count - model.fixed_nodes.size());
}

TEST_CASE("patch: a smaller one is the beginning of a larger one") {
  // Oracle: definition.
  const OrganModel model = testing::ball_model(3);
  const Neighbours neighbours(model, {});
  const std::vector<std::uint32_t> touched{5, 100, 17};
  Patch small, large;
  for (const auto& [size, patch] : {std::pair{32, &small}, std::pair{300, &large}}) {
    grow_patch(model, neighbours, model.rest_positions, touched, model.rest_positions[5],
               static_cast<std::size_t>(size), *patch);
  }
  REQUIRE(large.nodes.size() == 300);
  CHECK(std::equal(small.nodes.begin(), small.nodes.end(), large.nodes.begin()));
}

TEST_CASE("patch: beyond the nodes in reach little moves") {
  // Oracle: a membrane of triangles by hand: a node pulled by six springs k to its own mass m, all
  // others likewise, so (m + 6 k) u_i = k Σ u_j + f. Solved by relaxation on a lattice of 61 × 61,
  // one node pushed; what lies outside the circle of the nodes in reach moves by less than e⁻² of
  // the push. Springs count 3 k a node.
  for (const double stiffness : {4.0, 40.0}) {  // 3 k/m
    constexpr int kSide = 61;
    const double k = stiffness / 3, middle = kSide / 2;
    std::vector<double> u(kSide * kSide, 0.0);
    const auto index = [](int i, int j) { return static_cast<std::size_t>(i * kSide + j); };
    for (int sweep = 0; sweep < 2000; ++sweep) {
      for (int i = 1; i < kSide - 1; ++i) {
        for (int j = 1; j < kSide - 1; ++j) {
          const double sum = u[index(i + 1, j)] + u[index(i - 1, j)] + u[index(i, j + 1)] +
                             u[index(i, j - 1)] + u[index(i + 1, j - 1)] + u[index(i - 1, j + 1)];
          const bool pushed = i == kSide / 2 && j == kSide / 2;
          u[index(i, j)] = (k * sum + (pushed ? 1 : 0)) / (1 + 6 * k);
        }
      }
    }
    const double edges = 2 * std::numbers::pi / std::sqrt(3.0);
    const double radius =
        std::sqrt(static_cast<double>(nodes_in_reach(1, edges_in_reach(stiffness))) / edges);
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) {
        const double x = (i - middle) + 0.5 * (j - middle), y = std::sqrt(0.75) * (j - middle);
        if (std::hypot(x, y) < radius) continue;
        REQUIRE(u[index(i, j)] < std::exp(-2.0) * u[index(kSide / 2, kSide / 2)]);
      }
    }
  }
  CHECK(nodes_in_reach(7, 0) == 7);
}

}  // namespace
}  // namespace palpate::deformation
