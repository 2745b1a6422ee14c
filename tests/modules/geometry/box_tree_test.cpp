#include "modules/geometry/box_tree.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

namespace palpate::geometry {
namespace {

std::vector<BoxTree::Box> random_boxes(std::size_t count) {
  std::mt19937 random(17);
  const auto number = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<BoxTree::Box> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d low(number(), number(), number());
    boxes.emplace_back(low, low + 0.05 * Eigen::Vector3d(number(), number(), number()));
  }
  return boxes;
}

}  // namespace

TEST_CASE("box tree: branches hold their items, and each item is in one leaf") {
  // Oracle: definition.
  for (const std::size_t count : {0u, 1u, 4u, 5u, 777u}) {
    const BoxTree tree(random_boxes(count));
    std::vector<std::uint32_t> in_leaves;
    for (const BoxTree::Branch& branch : tree.branches()) {
      for (const std::uint32_t item : tree.items_of(branch)) {
        CHECK(branch.box.contains(tree.boxes()[item]));
        if (branch.left == 0) in_leaves.push_back(item);
      }
    }
    std::ranges::sort(in_leaves);
    REQUIRE(in_leaves.size() == count);
    for (std::uint32_t i = 0; i < count; ++i) CHECK(in_leaves[i] == i);
  }
}

TEST_CASE("box tree: of what is within a limit all is visited, and little else") {
  // Oracle: brute force over all boxes.
  const BoxTree tree(random_boxes(777));
  const Eigen::Vector3d place(0.3, 0.6, 0.4);
  for (const double limit : {0.0, 0.05, 0.2, 2.0}) {
    std::vector<std::uint32_t> visited;
    const auto distance = [&](const BoxTree::Box& box) {
      return box.squaredExteriorDistance(place);
    };
    tree.visit_near(
        distance, [&] { return limit * limit; },
        [&](std::uint32_t item) { visited.push_back(item); });
    std::ranges::sort(visited);
    std::size_t near = 0;
    for (std::uint32_t i = 0; i < 777; ++i) {
      if (distance(tree.boxes()[i]) > limit * limit) continue;
      ++near;
      CHECK(std::ranges::binary_search(visited, i));
    }
    CHECK(visited.size() <= 3 * near + 12);
  }
}

}  // namespace palpate::geometry
