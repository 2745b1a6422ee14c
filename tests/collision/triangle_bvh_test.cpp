#include "collision/triangle_bvh.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/collision/random_shapes.h"

namespace palpate::collision {
namespace {

Bounds bounds_of(const geometry::TriangleSurface& surface, std::uint32_t triangle) {
  Bounds box;
  for (const std::uint32_t node : surface.triangles[triangle]) box.add(surface.nodes[node]);
  return box;
}

/// How many triangles overlap the box; fails if the tree leaves one out.
std::size_t check_query(const TriangleBvh& bvh, const geometry::TriangleSurface& surface,
                        const Bounds& box) {
  std::vector<std::uint32_t> found;
  bvh.append_overlapping(box, found);
  std::sort(found.begin(), found.end());
  CHECK(std::adjacent_find(found.begin(), found.end()) == found.end());
  std::size_t wanted = 0;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    if (!bounds_of(surface, t).overlaps(box)) continue;
    ++wanted;
    if (!std::binary_search(found.begin(), found.end(), t)) FAIL_CHECK("left out " << t);
  }
  return wanted;
}

}  // namespace

TEST_CASE("triangle BVH: no overlapping triangle is left out, before and after the surface moves") {
  // Oracle: brute force over all triangles.
  RandomShapes random(31);
  auto surface = random.deformed_ball(0.05, 3);
  TriangleBvh bvh(surface.nodes, surface.triangles);
  std::size_t wanted = 0;
  // Small moves are followed by wider queries, large ones by moving the boxes.
  for (const double move : {0.0, 0.0002, 0.0005, 0.02, 0.3, 1e-5}) {
    for (Vec3& x : surface.nodes) x += random.point(move);
    bvh.move(surface.nodes);
    for (int query = 0; query < 20; ++query) {
      const Vec3 center = random.point(0.06);
      Bounds box{center, center};
      box.inflate(random.number(0, 0.02));
      wanted += check_query(bvh, surface, box);
    }
  }
  CHECK(wanted > 1000);
}

TEST_CASE("triangle BVH: a small box gives few of many triangles, also after a large move") {
  // Oracle: invariant; a tree whose boxes did not follow would have to give all.
  auto surface = geometry::make_ball(0.05, 4);
  TriangleBvh bvh(surface.nodes, surface.triangles);
  for (Vec3& x : surface.nodes) x[0] += 1;
  bvh.move(surface.nodes);
  Bounds box{surface.nodes[0], surface.nodes[0]};
  box.inflate(0.002);
  std::vector<std::uint32_t> found;
  bvh.append_overlapping(box, found);
  CHECK(found.size() >= 5);
  CHECK(found.size() < surface.triangles.size() / 50);
}

TEST_CASE("triangle BVH: a surface without triangles is never near") {
  // Oracle: analytic.
  TriangleBvh bvh({}, {});
  std::vector<std::uint32_t> found;
  bvh.append_overlapping({Vec3::Constant(-1), Vec3::Constant(1)}, found);
  bvh.move({});
  CHECK(found.empty());
}

TEST_CASE("bounds: boxes that share only a face overlap") {
  // Oracle: analytic.
  const Bounds one{Vec3(0, 0, 0), Vec3(1, 1, 1)}, beside{Vec3(1, 0, 0), Vec3(2, 1, 1)};
  const Bounds apart{Vec3(1.001, 0, 0), Vec3(2, 1, 1)};
  CHECK(one.overlaps(beside));
  CHECK_FALSE(one.overlaps(apart));
  CHECK_FALSE(Bounds().overlaps(one));
}

}  // namespace palpate::collision
