#include "modules/geometry/aabb_tree.h"

#include <cmath>
#include <random>
#include <set>

#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;

namespace {

class RandomPoint {
 public:
  Vec3 operator()() { return {offset_(random_), offset_(random_), offset_(random_)}; }

 private:
  std::mt19937 random_{11};
  std::uniform_real_distribution<double> offset_{-1.5, 1.5};
};

}  // namespace

TEST_CASE("nearest point on a triangle: never farther than any of many points of it") {
  // Oracle: brute force over a 60 × 60 barycentric lattice, whose spacing bounds the difference.
  RandomPoint random;
  for (int trial = 0; trial < 40; ++trial) {
    const Vec3 a = random(), b = random(), c = random(), p = random();
    const double found = (nearest_point_on_triangle(p, a, b, c) - p).norm();
    double brute = 1e9;
    const int n = 60;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; i + j <= n; ++j) {
        const Vec3 q = a + (b - a) * i / n + (c - a) * j / n;
        brute = std::min(brute, (q - p).norm());
      }
    }
    CHECK(found <= brute + 1e-12);
    CHECK(found >= brute - 6.0 / n);
  }
}

TEST_CASE("nearest: the tree finds the distance that brute force finds") {
  // Oracle: brute force over all triangles.
  const TriangleSurface surface = both(make_ball(1, 2), moved(make_box({1, 1, 1}, 3), {2, 0, 0}));
  const AabbTree tree(surface);
  RandomPoint random;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 p = random();
    double brute = 1e9;
    for (const auto& [a, b, c] : surface.triangles) {
      const Vec3 q =
          nearest_point_on_triangle(p, surface.nodes[a], surface.nodes[b], surface.nodes[c]);
      brute = std::min(brute, (q - p).squaredNorm());
    }
    const AabbTree::Nearest nearest = tree.nearest(p);
    CHECK(nearest.squared_distance == brute);
    CHECK((nearest.point - p).squaredNorm() == brute);
    const auto within = tree.nearest_within(p, std::nextafter(brute, 1e9));
    REQUIRE(within);
    CHECK(within->triangle == nearest.triangle);
    CHECK(within->squared_distance == brute);
    CHECK_FALSE(tree.nearest_within(p, brute));
  }
}

TEST_CASE("overlapping: the triangles whose boxes touch a box, none of no surface") {
  // Oracle: brute force over all triangles.
  const TriangleSurface surface = make_ball(1, 2);
  const AabbTree tree(surface);
  std::size_t count = 0;
  for (const double x : {-1.0, -0.3, 0.2, 0.9}) {
    const AabbTree::Box box(Vec3(x, x / 2, -0.8), Vec3(x + 0.4, x / 2 + 0.3, 1));
    std::vector<std::uint32_t> found, brute;
    tree.append_overlapping(box, found);
    std::sort(found.begin(), found.end());
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      AabbTree::Box own;
      for (const std::uint32_t node : surface.triangles[t]) own.extend(surface.nodes[node]);
      if (own.intersects(box)) brute.push_back(t);
    }
    CHECK(found == brute);
    count += found.size();
  }
  CHECK(count > 20);
  std::vector<std::uint32_t> none;
  AabbTree(TriangleSurface{})
      .append_overlapping(AabbTree::Box(Vec3(-1, -1, -1), Vec3(1, 1, 1)), none);
  CHECK(none.empty());
}

TEST_CASE("touching pairs: each pair of overlapping boxes exactly once") {
  // Oracle: brute force over all pairs.
  const TriangleSurface surface = both(make_ball(1, 1), moved(make_ball(1, 1), {0.5, 0.3, 0}));
  const auto box_of = [&](const Triangle& t) {
    Eigen::AlignedBox3d box(surface.nodes[t[0]]);
    return box.extend(surface.nodes[t[1]]).extend(surface.nodes[t[2]]);
  };
  std::set<std::pair<std::uint32_t, std::uint32_t>> brute, found;
  for (std::uint32_t a = 0; a < surface.triangles.size(); ++a) {
    for (std::uint32_t b = a + 1; b < surface.triangles.size(); ++b) {
      if (box_of(surface.triangles[a]).intersects(box_of(surface.triangles[b]))) {
        brute.insert({a, b});
      }
    }
  }
  AabbTree(surface).for_each_touching_pair([&](std::uint32_t a, std::uint32_t b) {
    CHECK(found.insert({a, b}).second);
  });
  CHECK(found == brute);
}
