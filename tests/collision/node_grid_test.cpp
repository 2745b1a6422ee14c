#include "collision/node_grid.h"

#include <catch2/catch.hpp>

#include "collision/probe_model.h"
#include "modules/scene/probe_shape.h"
#include "tests/collision/random_shapes.h"

namespace palpate::collision {
namespace {

NodeArray as_floats(const std::vector<Vec3>& nodes) {
  std::vector<float> floats;
  for (const Vec3& x : nodes) {
    for (const double along : x) floats.push_back(static_cast<float>(along));
  }
  NodeArray result;
  result.swap_in(floats);
  return result;
}

}  // namespace

TEST_CASE("node grid: a row is a node, the last one too, whatever it came as") {
  // Oracle: definition.
  const std::vector<Vec3> nodes{{1, 2, 3}, {4, 5, 6}};
  NodeArray doubles;
  doubles.assign(nodes);
  NodeArray floats = as_floats(nodes);
  for (const NodeArray* array : {&doubles, &floats}) {
    for (const std::uint32_t i : {0u, 1u}) {
      CHECK(row_of(*array, i).head<3>().cast<double>().matrix() == nodes[i]);
      CHECK(std::isfinite(row_of(*array, i)[3]));
    }
  }
}

TEST_CASE("node grid: a round core's distance from nodes, and from boxes never more") {
  // Oracle: closest() in doubles.
  RandomShapes random(9);
  for (const auto& form : {scene::form_of(scene::SphereShape{0.004}),
                           scene::form_of(scene::CapsuleShape{0.004, 0.03})}) {
    const ProbeModel probe(form);
    const Pose end{random.point(0.3), random.rotation()};
    const RelativeMotion motion({end, end}, probe.reach, probe.is_round);
    const CoreAtEnd core(motion, probe.cores[0], 0.05);
    for (int k = 0; k < 200; ++k) {
      const Vec3 x = end.position + random.point(0.03);
      const NodeArray node = as_floats({x});
      const Vec3 seen = motion.end(node[0]);
      const double distance = closest(probe.cores[0], {seen, seen, seen}).distance;
      CHECK(std::sqrt(core.squared_distance(row_of(node, 0))) == Approx(distance).margin(1e-6));
      geometry::BlockBox box;
      box.add(x);
      box.add(x + random.point(0.01));
      CHECK(std::sqrt(core.squared_distance(box)) <= distance);
    }
  }
}

TEST_CASE("node grid: the nearest node of each cell, the lower of two as near") {
  // Oracle: brute force.
  RandomShapes random(10);
  std::vector<Vec3> nodes;
  for (int k = 0; k < 500; ++k) nodes.push_back(random.point(1.2));  // some beyond the box
  nodes.push_back(nodes[3]);
  const NodeArray array = as_floats(nodes);
  constexpr int kCells = 4;
  NodeGrid grid(kCells);
  grid.begin(Vec3::Constant(-1), Vec3::Constant(2));
  geometry::BlockBox everywhere;
  everywhere.add(Vec3::Constant(-1));
  everywhere.add(Vec3::Constant(1));
  CHECK(grid.would_take(everywhere, 1e9F));
  const auto squared = [&](std::uint32_t i) { return static_cast<float>(array[i].squaredNorm()); };
  for (std::uint32_t i = 0; i < nodes.size(); ++i) grid.take(row_of(array, i), squared(i), i);
  std::array<std::uint32_t, kCells * kCells * kCells> nearest{};
  nearest.fill(0xffffffff);
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    std::size_t cell = 0;
    for (const double along : array[i]) {
      const int at = std::clamp(int(std::floor((along + 1) / 2 * kCells)), 0, kCells - 1);
      cell = kCells * cell + static_cast<std::size_t>(at);
    }
    std::uint32_t& kept = nearest[cell];
    if (kept == 0xffffffff || squared(i) < squared(kept)) kept = i;
  }
  for (std::size_t cell = 0; cell < nearest.size(); ++cell) {
    REQUIRE(grid.places()[cell].is_taken() == (nearest[cell] != 0xffffffff));
    if (grid.places()[cell].is_taken()) CHECK(grid.places()[cell].node == nearest[cell]);
  }
  CHECK_FALSE(grid.would_take(everywhere, 3.1F));
  CHECK(grid.would_take(everywhere, 0));
}

}  // namespace palpate::collision
