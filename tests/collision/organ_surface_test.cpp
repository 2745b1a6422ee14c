#include "collision/organ_surface.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/collision/random_shapes.h"

namespace palpate::collision {
namespace {

std::vector<Vec3> places_of(const NodeArray& nodes) {
  std::vector<Vec3> result;
  for (std::uint32_t i = 0; i < nodes.size(); ++i) result.push_back(nodes[i]);
  return result;
}

}  // namespace

TEST_CASE("organ surface: edges and triangles around nodes of a ball") {
  // Oracle: Euler's formula, E = 3 F / 2 and every edge between two triangles.
  const auto ball = geometry::make_ball(1, 2);
  const OrganSurface organ(ball.triangles);
  CHECK(organ.edges().size() == geometry::edges_of(ball.triangles).size());
  CHECK(2 * organ.edges().size() == 3 * ball.triangles.size());
  std::size_t sides = 0;
  for (std::uint32_t t = 0; t < ball.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const SurfaceEdge& edge = organ.edges()[organ.edges_of_triangle(t)[k]];
      CHECK((edge.triangles[0] == t || edge.triangles[1] == t));
      CHECK(edge.triangles[0] < edge.triangles[1]);
      const auto [a, b] = std::minmax(ball.triangles[t][k], ball.triangles[t][(k + 1) % 3]);
      CHECK(edge.nodes == std::array{a, b});
    }
  }
  for (std::uint32_t node = 0; node < ball.nodes.size(); ++node) {
    const auto around = organ.triangles_of_node(node);
    CHECK(std::is_sorted(around.begin(), around.end()));
    sides += around.size();
  }
  CHECK(sides == 3 * ball.triangles.size());
}

TEST_CASE("organ surface: a border edge names its triangle twice") {
  // Oracle: analytic.
  const OrganSurface organ({{0, 1, 2}});
  REQUIRE(organ.edges().size() == 3);
  for (const SurfaceEdge& edge : organ.edges()) CHECK(edge.triangles == std::array{0u, 0u});
}

TEST_CASE("organ surface: keeps the positions before the newest, if something was found on them") {
  // Oracle: analytic.
  OrganSurface organ({{0, 1, 2}});
  const auto shifted = [](double by) {
    return std::vector<Vec3>{Vec3(by, 0, 0), Vec3(1 + by, 0, 0), Vec3(by, 1, 0)};
  };
  CHECK_FALSE(organ.present());
  organ.update(shifted(0));
  const auto first = organ.version();
  CHECK(places_of(organ.positions_at(first)) == shifted(0));
  organ.mark_found();
  organ.update(shifted(1));
  CHECK(places_of(organ.positions_at(first)) == shifted(0));
  organ.update(shifted(3));  // nothing was found on the second
  CHECK(places_of(organ.positions_at(first)) == shifted(0));
  CHECK(places_of(organ.positions_at(organ.version())) == shifted(3));
  organ.mark_found();
  organ.update(shifted(4));
  CHECK(places_of(organ.positions_at(first)) == shifted(4));  // forgotten: taken as at rest
}

TEST_CASE(
    "organ surface: positions beyond its nodes are not looked at, not finite ones take it out") {
  // Oracle: analytic.
  OrganSurface organ({{0, 1, 2}});
  std::vector<Vec3> nodes{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(NAN, 0, 0)};
  organ.update(nodes);
  CHECK(organ.present());
  CHECK(organ.node_count() == 3);
  nodes[1][2] = INFINITY;
  organ.update(nodes);
  CHECK_FALSE(organ.present());
  nodes[1][2] = 0;
  organ.mark_found();
  organ.update(nodes);
  CHECK(organ.present());
}

TEST_CASE("organ surface: the wire's floats are taken without a copy and kept for a step") {
  // Oracle: definition.
  const auto ball = geometry::make_ball(1, 2);
  const auto block = geometry::SurfaceBlocks::split(ball.nodes, ball.triangles, 20);
  const geometry::SurfaceBlocks blocks(ball.triangles, block);
  OrganSurface organ(ball.triangles, block);
  std::vector<float> floats;
  for (const Vec3& x : ball.nodes) {
    for (int k = 0; k < 3; ++k) floats.push_back(static_cast<float>(x[k]));
  }
  std::vector<geometry::BlockBox> boxes;
  blocks.bound(floats, boxes);
  const auto told = boxes;
  std::vector<float> moved = floats;
  for (float& x : moved) x += 1;
  const float* const memory = moved.data();
  organ.take(floats, boxes);
  CHECK(organ.boxes() == told);
  organ.mark_found();
  const auto first = organ.version();
  boxes.clear();  // not told: made here
  organ.take(moved, boxes);
  CHECK(organ.positions().floats().data() == memory);
  CHECK(organ.boxes_at(first) == told);
  CHECK(organ.positions()[5] - organ.positions_at(first)[5] == Vec3(1, 1, 1));
  CHECK(organ.bounds().upper[0] == Approx(2));
  CHECK(organ.boxes()[0].lower[0] == Approx(told[0].lower[0] + 1));

  boxes = told;
  boxes[1].lower[0] = NAN;
  moved.assign(organ.positions().floats().begin(), organ.positions().floats().end());
  organ.take(moved, boxes);
  CHECK_FALSE(organ.present());
  boxes.clear();
  moved[4] = INFINITY;
  organ.take(moved, boxes);
  CHECK_FALSE(organ.present());
  moved[4] = 0;
  organ.take(moved, boxes);
  CHECK(organ.present());
}

TEST_CASE("organ surface: overlapping triangles, all and no other, before and after it moves") {
  // Oracle: brute force over all triangles.
  RandomShapes random(31);
  auto surface = random.deformed_ball(0.05, 3);
  OrganSurface organ(surface.triangles);
  std::size_t count = 0;
  for (const double move : {0.0, 0.0002, 0.02, 0.3, 1e-5}) {
    for (Vec3& x : surface.nodes) x += random.point(move);
    organ.update(surface.nodes);
    for (int query = 0; query < 20; ++query) {
      const Vec3 centre = random.point(0.06);
      Bounds box{centre, centre};
      box.inflate(random.number(0, 0.02));
      std::vector<std::uint32_t> found, expected;
      organ.append_overlapping(box, found);
      std::sort(found.begin(), found.end());
      for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
        Bounds own;
        for (const std::uint32_t node : surface.triangles[t]) own.add(surface.nodes[node]);
        if (own.overlaps(box)) expected.push_back(t);
      }
      CHECK(found == expected);
      count += found.size();
    }
  }
  CHECK(count > 1000);
}

}  // namespace palpate::collision
