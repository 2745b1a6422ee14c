#include "modules/geometry/edge_uses.h"

#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;

TEST_CASE("edge uses: each edge of a closed oriented surface is used once in each direction") {
  // Oracle: definition of a closed oriented manifold.
  const TriangleSurface ball = make_ball(1, 1);
  const auto uses = edge_uses_of(ball.triangles);
  REQUIRE(uses.size() == 3 * ball.triangles.size());
  std::size_t edges = 0;
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    ++edges;
    REQUIRE(edge.size() == 2);
    CHECK(edge[0].a < edge[0].b);
    CHECK(edge[0].forward != edge[1].forward);
  });
  CHECK(edges == edges_of(ball.triangles).size());
}

TEST_CASE("edge uses: a side from a node to itself is left out") {
  // Oracle: hand-made.
  const std::vector<Triangle> triangles{{4, 4, 2}};
  CHECK(edge_uses_of(triangles).size() == 2);
}

TEST_CASE("neighbours: the other ends of each node's edges, in order") {
  // Oracle: brute force over all edges of a ball, and a node of none.
  const TriangleSurface ball = make_ball(1, 1);
  const auto edges = edges_of(ball.triangles);
  const auto neighbours = neighbours_of(ball.nodes.size() + 1, edges);
  REQUIRE(neighbours.size() == ball.nodes.size() + 1);
  CHECK(neighbours.back().empty());
  for (std::uint32_t node = 0; node < ball.nodes.size(); ++node) {
    std::vector<std::uint32_t> expected;
    for (const auto& [a, b] : edges) {
      if (a == node) expected.push_back(b);
      if (b == node) expected.push_back(a);
    }
    std::sort(expected.begin(), expected.end());
    CHECK(neighbours[node] == expected);
  }
}

TEST_CASE("disjoint sets: joined items share a root, the lowest of them") {
  // Oracle: hand-made.
  DisjointSets sets(6);
  sets.join(5, 3);
  sets.join(3, 1);
  CHECK(sets.root(5) == 1);
  CHECK(sets.root(3) == 1);
  CHECK(sets.root(0) == 0);
  CHECK(sets.root(4) == 4);
}
