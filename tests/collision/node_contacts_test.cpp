#include "collision/node_contacts.h"

#include <catch2/catch.hpp>

#include "tests/collision/step_scene.h"

namespace palpate::collision {
namespace {

std::vector<FoundContact> find(NodeContacts& nodes, const StepScene& scene,
                               const ProbeSolid& solid) {
  std::vector<FoundContact> found;
  nodes.begin_step();
  nodes.find(scene.step, solid, scene.nodes(), found);
  return found;
}

}  // namespace

TEST_CASE(
    "node contacts: nodes before a box, each with its distance, named by its lowest triangle") {
  // Oracle: analytic; the organ's top is 0.05 under the box's bottom.
  const auto solid = make_box_solid({1, 1, 1});
  const StepScene scene(box_at({0, 0, -1.05}, {4, 4, 1}, 8), Vec3::Zero());
  NodeContacts nodes;
  const auto found = find(nodes, scene, *solid);
  CHECK(found.size() == 9);  // a grid of 0.5 under a face of 1
  for (const FoundContact& c : found) {
    CHECK(c.gap == Approx(0.05).margin(1e-12));
    CHECK((c.normal_P - Vec3::UnitZ()).norm() < 1e-12);
    CHECK(c.barycentric.maxCoeff() == 1);
    CHECK(c.triangle == scene.organ.triangles_of_node(c.feature[0])[0]);
  }
}

TEST_CASE("node contacts: nodes that look away from the probe are left out") {
  // Oracle: analytic; the box hangs inside a shell, near its bottom wall.
  const auto solid = make_box_solid({1, 1, 1});
  const StepScene scene(box_at({0, 0, 1.45}, {4, 4, 4}, 8), Vec3::Zero());
  NodeContacts nodes;
  CHECK(find(nodes, scene, *solid).empty());
}

TEST_CASE(
    "node contacts: nodes that entered keep the face they came through, also behind the box") {
  // Oracle: analytic; the organ's top comes from below the box, ends inside it, then above it.
  const auto solid = make_box_solid({1, 1, 0.4});
  NodeContacts nodes;
  double last = 0;
  for (const double top : {0.1, 0.15, 0.9}) {
    const StepScene scene(box_at({0, 0, top - 2}, {4, 4, 4}, 8),
                          {0, 0, last == 0 ? 1 : top - last});
    const auto found = find(nodes, scene, *solid);
    REQUIRE(found.size() == 9);
    for (const FoundContact& c : found) {
      CHECK(c.gap == Approx(-0.2 - top).margin(1e-12));
      CHECK((c.normal_P - Vec3::UnitZ()).norm() < 1e-12);
    }
    last = top;
  }
  // Back under the box they are free again.
  const StepScene under(box_at({0, 0, -0.25 - 2}, {4, 4, 4}, 8), {0, 0, -1.15});
  for (const FoundContact& c : find(nodes, under, *solid)) CHECK(c.gap == Approx(0.05));
  std::vector<std::uint32_t> remembered;
  nodes.begin_step();
  nodes.append_remembered(0, remembered);
  CHECK(remembered.empty());
}

TEST_CASE("node contacts: deeper than believed, or after a reset, a hold is given up") {
  // Oracle: analytic.
  const auto solid = make_box_solid({1, 1, 0.4});
  const auto organ = box_at({0, 0, 0.9 - 2}, {4, 4, 4}, 8);
  for (const double limit : {2.0, 0.5}) {
    NodeContacts nodes;
    const auto found = find(nodes, StepScene(organ, {0, 0, 2}, 0.1, limit), *solid);
    CHECK(found.empty() == (limit < 1.1));
    nodes.reset();
    CHECK(find(nodes, StepScene(organ, Vec3::Zero(), 0.1, limit), *solid).empty());
  }
}

TEST_CASE("node contacts: inside a half-space every facing node counts, whatever its depth") {
  // Oracle: analytic; a half-space has no other side.
  const auto solid = make_half_space();
  const auto organ = box_at({0, 0, -3}, {1, 1, 1});  // wholly inside, its bottom faces down
  NodeContacts nodes;
  const auto found = find(nodes, StepScene(organ, Vec3::Zero()), *solid);
  CHECK(found.size() == 4);
  for (const FoundContact& c : found) {
    CHECK(c.normal_P == -Vec3::UnitZ());
    CHECK(c.gap == Approx(-3.5));
  }
}

}  // namespace palpate::collision
