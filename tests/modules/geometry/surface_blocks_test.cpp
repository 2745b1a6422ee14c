#include "modules/geometry/surface_blocks.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "modules/geometry/primitives.h"

namespace palpate::geometry {
namespace {

constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();

/// Box of all corners of the block's triangles, in doubles.
Eigen::AlignedBox3d exact_block_box(const TriangleSurface& surface, const SurfaceBlocks& blocks,
                                    std::size_t block) {
  Eigen::AlignedBox3d box;
  for (const std::uint32_t t : blocks.triangles_of(block)) {
    for (const std::uint32_t node : surface.triangles[t]) box.extend(surface.nodes[node]);
  }
  return box;
}

bool box_holds(const BlockBox& box, const Eigen::AlignedBox3d& exact) {
  bool all = true;
  for (int k = 0; k < 3; ++k) {
    all &= double{box.lower[k]} <= exact.min()[k] && double{box.upper[k]} >= exact.max()[k];
  }
  return all;
}

}  // namespace

TEST_CASE("surface blocks: every triangle in one small compact block, corners by their places") {
  // Oracle: definition; a block of a ball cut into some forty reaches over a fraction of it.
  const TriangleSurface ball = make_ball(1, 4);
  const SurfaceBlocks blocks(ball.triangles, SurfaceBlocks::split(ball.nodes, ball.triangles));
  CHECK(blocks.count() >= ball.triangles.size() / SurfaceBlocks::kMostTriangles);
  CHECK(blocks.count() <= 4 * ball.triangles.size() / SurfaceBlocks::kMostTriangles);
  std::set<std::uint32_t> seen;
  for (std::size_t block = 0; block < blocks.count(); ++block) {
    const auto triangles = blocks.triangles_of(block), nodes = blocks.nodes_of(block);
    const auto corners = blocks.corners_of(block);
    CHECK(triangles.size() <= SurfaceBlocks::kMostTriangles);
    CHECK(std::is_sorted(triangles.begin(), triangles.end()));
    REQUIRE(corners.size() == triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      CHECK(seen.insert(triangles[i]).second);
      for (int k = 0; k < 3; ++k) {
        CHECK(nodes[corners[i][k]] == ball.triangles[triangles[i]][k]);
      }
    }
    CHECK(exact_block_box(ball, blocks, block).sizes().maxCoeff() < 1);
  }
  CHECK(seen.size() == ball.triangles.size());
}

TEST_CASE("surface blocks: boxes hold their nodes, of doubles and of floats, and are tight") {
  // Oracle: the box of all corners. A float next to x is within 1.2e-7 |x|.
  const TriangleSurface ball = make_ball(1, 3);
  const SurfaceBlocks blocks(ball.triangles, SurfaceBlocks::split(ball.nodes, ball.triangles, 10));
  std::vector<BlockBox> boxes, of_floats;
  blocks.bound(ball.nodes, boxes);
  TriangleSurface rounded = ball;
  std::vector<float> floats;
  for (Vec3& x : rounded.nodes) {
    for (int k = 0; k < 3; ++k) floats.push_back(static_cast<float>(x[k]));
    x = x.cast<float>().cast<double>();
  }
  blocks.bound(floats, of_floats);
  REQUIRE(boxes.size() == blocks.count());
  for (std::size_t block = 0; block < blocks.count(); ++block) {
    const auto exact = exact_block_box(ball, blocks, block),
               single = exact_block_box(rounded, blocks, block);
    CHECK(box_holds(boxes[block], exact));
    CHECK(box_holds(of_floats[block], single));
    for (int k = 0; k < 3; ++k) {
      CHECK(boxes[block].lower[k] == Approx(exact.min()[k]).margin(1.2e-7));
      CHECK(double{of_floats[block].lower[k]} == single.min()[k]);
      CHECK(double{of_floats[block].upper[k]} == single.max()[k]);
    }
  }
}

TEST_CASE("surface blocks: a box is rounded outwards, by one float at most, whatever the number") {
  // Oracle: std::nextafter. Numbers between floats, next to zero, subnormal, and beyond all floats.
  constexpr float kFar = std::numeric_limits<float>::infinity();
  const auto below = [](double x) {
    const auto nearest = static_cast<float>(x);
    return nearest > x ? std::nextafter(nearest, -kFar) : nearest;
  };
  for (const double size : {0.0, 1e-46, 1e-45, 3e-42, 1.1754943e-38, 0.1, 1.0, 1 + 1e-9, 16777217.0,
                            3.4028234e38, 3.4028236e38, 1e39, 1e300}) {
    for (const double x : {size, -size}) {
      BlockBox box;
      box.add({x, 0.5, -0.5});
      CHECK(box.lower[0] == below(x));
      CHECK(box.upper[0] == -below(-x));
      CHECK(box.lower[0] <= x);
      CHECK(box.upper[0] >= x);
    }
  }
}

TEST_CASE("surface blocks: groups hold their blocks' boxes, tightly") {
  // Oracle: definition.
  const TriangleSurface ball = make_ball(1, 4);
  const SurfaceBlocks blocks(ball.triangles, SurfaceBlocks::split(ball.nodes, ball.triangles, 40));
  std::vector<BlockBox> boxes, groups;
  blocks.bound(ball.nodes, boxes);
  REQUIRE(boxes.size() % kBlocksOfGroup == 0);
  boxes.pop_back();  // the last group need not be full
  CHECK(bound_groups(boxes, groups));
  REQUIRE(groups.size() == boxes.size() / kBlocksOfGroup + 1);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    Eigen::AlignedBox3f all;
    for (std::size_t b = g * kBlocksOfGroup; b < std::min(boxes.size(), (g + 1) * kBlocksOfGroup);
         ++b) {
      all.extend(Eigen::Map<const Eigen::Vector3f>(boxes[b].lower.data()));
      all.extend(Eigen::Map<const Eigen::Vector3f>(boxes[b].upper.data()));
    }
    CHECK(Eigen::Map<const Eigen::Vector3f>(groups[g].lower.data()) == all.min());
    CHECK(Eigen::Map<const Eigen::Vector3f>(groups[g].upper.data()) == all.max());
    CHECK(all.sizes().maxCoeff() < 1.5);  // neighbours
  }
}

TEST_CASE("surface blocks: a number that is not finite shows as boxes are grouped") {
  // Oracle: definition.
  std::vector<BlockBox> boxes(3), groups;
  CHECK_FALSE(bound_groups(boxes, groups));  // empty ones have no end
  for (BlockBox& box : boxes) box.add(Vec3(1, 2, 3));
  CHECK(bound_groups(boxes, groups));
  for (BlockBox& box : boxes) {
    for (float* const side : {box.lower.data(), box.upper.data()}) {
      for (int k = 0; k < 3; ++k) {
        for (const float wrong : {kNoNumber, std::numeric_limits<float>::infinity(),
                                  -std::numeric_limits<float>::infinity()}) {
          const float right = std::exchange(side[k], wrong);
          CHECK_FALSE(bound_groups(boxes, groups));
          side[k] = right;
        }
      }
    }
  }
}

TEST_CASE("surface blocks: none of no triangles") {
  // Oracle: definition.
  CHECK(SurfaceBlocks().count() == 0);
  CHECK(SurfaceBlocks::split({}, {}).empty());
  CHECK(SurfaceBlocks({}, {}).count() == 0);
}

}  // namespace palpate::geometry
