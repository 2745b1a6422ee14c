#include "deformation/model/patch.h"

#include <catch2/catch.hpp>

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

}  // namespace
}  // namespace palpate::deformation
