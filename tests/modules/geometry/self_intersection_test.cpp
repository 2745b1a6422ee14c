#include "modules/geometry/self_intersection.h"

#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;

namespace {

/// The first triangle is (0,0,0) (4,0,0) (0,4,0); the other three nodes as given.
bool crosses(const Vec3& p, const Vec3& q, const Vec3& r) {
  const std::vector<Vec3> nodes{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, p, q, r};
  const bool one = triangles_intersect(nodes, {0, 1, 2}, {3, 4, 5});
  CHECK(one == triangles_intersect(nodes, {3, 4, 5}, {0, 1, 2}));
  CHECK(one == triangles_intersect(nodes, {2, 1, 0}, {4, 5, 3}));
  return one;
}

/// The second triangle shares node 0 at the origin.
bool crosses_at_corner(const Vec3& p, const Vec3& q) {
  const std::vector<Vec3> nodes{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, p, q};
  const bool one = triangles_intersect(nodes, {0, 1, 2}, {0, 3, 4});
  CHECK(one == triangles_intersect(nodes, {3, 4, 0}, {1, 2, 0}));
  return one;
}

}  // namespace

TEST_CASE("triangle pairs without common nodes: crossing, apart, touching") {
  // Oracle: drawn by hand.
  CHECK(crosses({1, 1, -1}, {1, 1, 1}, {9, 9, 1}));             // an edge of the second pierces
  CHECK(crosses({-1, -1, -1}, {-1, -1, 1}, {9, 9, 0}));         // edges of the first pierce
  CHECK_FALSE(crosses({1, 1, 0.1}, {2, 1, 0.1}, {1, 2, 0.1}));  // parallel, above
  CHECK_FALSE(crosses({5, 5, -1}, {5, 5, 1}, {9, 9, 0}));       // beside
  CHECK(crosses({1, 1, 0}, {1, 1, 1}, {2, 1, 1}));              // a corner on the face
}

TEST_CASE("triangle pairs in one plane: overlapping and beside each other") {
  // Oracle: drawn by hand.
  CHECK(crosses({1, 1, 0}, {5, 1, 0}, {1, 5, 0}));
  CHECK(crosses({0.5, 0.5, 0}, {1, 0.5, 0}, {0.5, 1, 0}));  // wholly inside
  CHECK_FALSE(crosses({4, 4, 0}, {4, 1, 0}, {1, 4, 0}));    // across the long edge
  CHECK_FALSE(crosses({0, -1, 0}, {4, -1, 0}, {2, -3, 0}));
}

TEST_CASE("triangle pairs with one common node: only more than the node counts") {
  // Oracle: drawn by hand.
  CHECK_FALSE(crosses_at_corner({0, 0, 1}, {1, 0, 1}));
  CHECK_FALSE(crosses_at_corner({-1, -1, 1}, {-1, -1, -1}));
  CHECK(crosses_at_corner({1, 1, -1}, {1, 1, 1}));         // its far edge pierces the first
  CHECK(crosses_at_corner({9, 9, -1}, {9, 9, 1}));         // the first one's far edge pierces it
  CHECK_FALSE(crosses_at_corner({-1, 0, 0}, {0, -1, 0}));  // same plane, opposite corner
  CHECK(crosses_at_corner({4, 1, 0}, {1, 4, 0}));          // same plane, same corner
}

TEST_CASE("triangle pairs with a common edge: only lying on each other counts") {
  // Oracle: drawn by hand: second apex above, beyond the edge, and folded onto the first.
  const std::vector<Vec3> nodes{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 3}, {1, -2, 0}, {1, 1, 0}};
  CHECK_FALSE(triangles_intersect(nodes, {0, 1, 2}, {1, 0, 3}));
  CHECK_FALSE(triangles_intersect(nodes, {0, 1, 2}, {1, 0, 4}));
  CHECK(triangles_intersect(nodes, {0, 1, 2}, {1, 0, 5}));
  CHECK(triangles_intersect(nodes, {0, 1, 2}, {2, 1, 0}));  // the same triangle, turned
}

TEST_CASE("self-intersections: none on sound surfaces, flat faces included") {
  // Oracle: convex surfaces do not cross themselves.
  CHECK(find_self_intersections(make_ball(0.05, 3)).empty());
  CHECK(find_self_intersections(make_box({0.1, 0.2, 0.3}, 5)).empty());
  CHECK(find_self_intersections(moved(make_capsule(0.01, 0.1), {3, 3, 3})).empty());
  CHECK(find_self_intersections({}).empty());
}

TEST_CASE("self-intersections: the same pairs as brute force over all pairs") {
  // Oracle: brute force.
  const TriangleSurface surface = both(make_ball(1, 2), moved(make_ball(1, 2), {0.9, 0.4, 0.2}));
  std::vector<std::array<std::uint32_t, 2>> brute;
  for (std::uint32_t a = 0; a < surface.triangles.size(); ++a) {
    for (std::uint32_t b = a + 1; b < surface.triangles.size(); ++b) {
      if (triangles_intersect(surface.nodes, surface.triangles[a], surface.triangles[b])) {
        brute.push_back({a, b});
      }
    }
  }
  CHECK(brute.size() > 20);
  CHECK(find_self_intersections(surface) == brute);
}

TEST_CASE("self-intersections: a dent pushed through the far side is found") {
  // Oracle: hand-made: the top of a ball moved below its bottom.
  TriangleSurface surface = make_ball(1, 2);
  for (Vec3& node : surface.nodes) {
    if (node.z() > 0.9) node.z() = -1.5;
  }
  CHECK_FALSE(find_self_intersections(surface).empty());
}
