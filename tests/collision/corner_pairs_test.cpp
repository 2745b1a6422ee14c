#include "collision/corner_pairs.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "modules/geometry/closest_points.h"
#include "tests/collision/step_scene.h"

namespace palpate::collision {
namespace {

ProbeModel ball(double radius, int halvings) {
  return ProbeModel(geometry::ProbeForm(geometry::make_ball(radius, halvings)));
}

geometry::TriangleSurface ball_at(const Vec3& at, double radius, int halvings) {
  auto result = geometry::make_ball(radius, halvings);
  for (Vec3& x : result.nodes) x += at;
  return result;
}

double distance(const ProbeModel& probe, const CornerPairs::Pair& pair,
                const std::vector<SweptTriangle>& triangles) {
  const Vec3& x = probe.sharp->vertices()[pair.first];
  return (x - geometry::closest_on_triangle(x, triangles[pair.second].end).point).norm();
}

}  // namespace

TEST_CASE("corner pairs: of few, each that may come near is there once") {
  // Oracle: brute force over all pairs.
  const ProbeModel probe = ball(0.02, 2);
  const StepScene scene(ball_at({0, 0, -0.071}, 0.05, 3), {0, 0.002, 0.001}, 0.004);
  const auto triangles = scene.triangles();
  CornerPairs pairs;
  CHECK_FALSE(pairs.list(scene.step, probe, triangles));
  const auto found = pairs.pairs();
  REQUIRE_FALSE(found.empty());
  CHECK(std::is_sorted(found.begin(), found.end()));
  CHECK(std::adjacent_find(found.begin(), found.end()) == found.end());
  std::size_t near = 0;
  for (std::uint32_t corner = 0; corner < probe.sharp->vertices().size(); ++corner) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      if (distance(probe, {corner, t}, triangles) > scene.step.margin) continue;
      ++near;
      CHECK(std::binary_search(found.begin(), found.end(), CornerPairs::Pair{corner, t}));
    }
  }
  CHECK(near > 20);
  CHECK_FALSE(pairs.was_cut());
}

TEST_CASE("corner pairs: of many, each triangle has its nearest corners") {
  // Oracle: brute force over all corners.
  const ProbeModel probe = ball(0.02, 5);
  const StepScene scene(ball_at({0, 0, -0.071}, 0.05, 3), Vec3::Zero(), 0.02);
  const auto triangles = scene.triangles();
  CornerPairs pairs;
  CHECK_FALSE(pairs.list(scene.step, probe, triangles));
  CHECK(pairs.pairs().size() <= CornerPairs::kManyPairs);
  const std::size_t of_each = CornerPairs::kManyPairs / triangles.size();
  REQUIRE(of_each >= CornerPairs::kFewestOfEach);
  std::size_t full = 0;
  for (std::uint32_t t = 0; t < triangles.size(); t += 37) {
    std::vector<double> found, all;
    for (const auto& pair : pairs.pairs()) {
      if (pair.second == t) found.push_back(distance(probe, pair, triangles));
    }
    for (std::uint32_t corner = 0; corner < probe.sharp->vertices().size(); ++corner) {
      const double of_corner = distance(probe, {corner, t}, triangles);
      if (of_corner <= scene.step.margin) all.push_back(of_corner);
    }
    std::ranges::sort(found);
    std::ranges::sort(all);
    all.resize(std::min(all.size(), of_each));
    CHECK(found == all);
    full += found.size() == of_each;
  }
  CHECK(full > 0);
}

TEST_CASE("corner pairs: more triangles than there may be pairs are told, and listed") {
  // Oracle: by construction, 20,480 triangles.
  const ProbeModel probe = ball(0.02, 3);
  const StepScene scene(ball_at({0, 0, -0.071}, 0.05, 5), Vec3::Zero(), 0.2);
  const auto triangles = scene.triangles();
  CornerPairs pairs;
  CHECK(pairs.list(scene.step, probe, triangles));
  CHECK(pairs.pairs().size() == CornerPairs::kFewestOfEach * triangles.size());
  const ProbeModel box{geometry::ProbeForm(geometry::Box{Vec3(0.02, 0.02, 0.02)})};
  CHECK_FALSE(pairs.list(scene.step, box, triangles));
  CHECK(pairs.pairs().size() == 8 * triangles.size());
}

TEST_CASE("corner pairs: of very many corners behind walls each has what is nearest to it") {
  // Oracle: brute force over all triangles; all corners are inside.
  const ProbeModel probe = ball(0.02, 4);
  const StepScene scene(ball_at({0, 0, -0.02}, 0.05, 4), Vec3::Zero(), 0.002);
  const auto triangles = scene.triangles();
  const auto count = static_cast<std::uint32_t>(probe.sharp->vertices().size());
  CoreContacts cores;
  cores.begin_step();
  for (std::uint32_t i = 0; i < count; ++i) {
    REQUIRE(cores.hold_if_inside(scene.step, probe.core(i)));
  }
  CornerPairs pairs;
  std::vector<std::uint32_t> walls;
  pairs.hold(scene.step, probe, cores, walls);
  CHECK(walls.size() == CornerPairs::kLeastWall * count);
  CHECK(cores.wall_was_cut());
  pairs.list(scene.step, probe, triangles);
  for (std::uint32_t corner = 0; corner < count; corner += 17) {
    double nearest = 1, found = 1;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      nearest = std::min(nearest, distance(probe, {corner, t}, triangles));
    }
    for (const auto& pair : pairs.pairs()) {
      if (pair.first == corner) found = std::min(found, distance(probe, pair, triangles));
    }
    CHECK(found == nearest);
  }
}

}  // namespace palpate::collision
