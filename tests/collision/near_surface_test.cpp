#include "collision/near_surface.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "collision/probe_model.h"
#include "modules/geometry/primitives.h"
#include "modules/scene/probe_shape.h"
#include "tests/collision/random_shapes.h"

namespace palpate::collision {
namespace {

ProbeMotion random_way(RandomShapes& random) {
  const Pose start{random.point(0.06), random.rotation()};
  const Quat turn(Eigen::AngleAxisd(random.number(0, 0.2), random.direction()));
  return {start, {start.position + random.point(0.01), turn * start.rotation}};
}

struct SplitOrgans {
  RandomShapes random{17};
  geometry::TriangleSurface ball = random.deformed_ball(0.05, 3);
  std::vector<OrganSurface> organs;  ///< the same, in blocks of different sizes

  SplitOrgans() {
    for (const std::size_t most : {std::size_t{1}, std::size_t{20}, ball.triangles.size()}) {
      organs.emplace_back(ball.triangles,
                          geometry::SurfaceBlocks::split(ball.nodes, ball.triangles, most));
    }
  }
  void move() {
    for (Vec3& x : ball.nodes) x += random.point(0.003);
    for (OrganSurface& organ : organs) {
      organ.update(ball.nodes);
      organ.mark_found();
    }
  }
};

bool same_triangles(const std::vector<SweptTriangle>& one,
                    const std::vector<SweptTriangle>& other) {
  return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [](const SweptTriangle& a, const SweptTriangle& b) {
                      return a.index == b.index && a.nodes == b.nodes && a.start == b.start &&
                             a.end == b.end && a.normal_end == b.normal_end && a.travel == b.travel;
                    });
}

}  // namespace

TEST_CASE("near surface: the same triangles whatever the blocks, and none within reach left out") {
  // Oracle: brute force; one block of all triangles, and the distance of every triangle from
  // points of the probe's core at both ends of the step.
  SplitOrgans scene;
  scene.move();
  std::size_t found = 0, near = 0;
  for (int step = 0; step < 60; ++step) {
    const std::uint64_t before = scene.organs[0].version();
    scene.move();
    const ProbeModel probe(scene::form_of(scene::CapsuleShape{0.004, 0.03}));
    const RelativeMotion motion(random_way(scene.random), probe.reach, probe.is_round);
    const double reach = probe.hull_radius + 0.002;
    std::array<NearSurface, 3> by_blocks;
    for (std::size_t i = 0; i < scene.organs.size(); ++i) {
      by_blocks[i].gather({0, scene.organs[i], motion, before, 0.002, 1}, probe.hull, reach);
    }
    const auto& all = by_blocks[2].triangles();
    CHECK(same_triangles(by_blocks[0].triangles(), all));
    CHECK(same_triangles(by_blocks[1].triangles(), all));
    found += all.size();
    SweptTriangle triangle;
    const OrganStep whole{0, scene.organs[2], motion, before, 0.002, 1};
    for (std::uint32_t t = 0; t < scene.ball.triangles.size(); ++t) {
      if (!whole.sweep(t, triangle)) continue;
      const bool is_near = closest(probe.cores[0], triangle.start).distance <= reach ||
                           closest(probe.cores[0], triangle.end).distance <= reach;
      near += is_near;
      const auto at =
          std::lower_bound(all.begin(), all.end(), t,
                           [](const SweptTriangle& s, std::uint32_t k) { return s.index < k; });
      if (is_near) CHECK((at != all.end() && at->index == t));
    }
  }
  CHECK(near > 500);
  CHECK(found < 8 * near);
}

TEST_CASE(
    "near surface: of very many triangles all that may be touched are there, and some of the "
    "others all around") {
  // Oracle: brute force over all triangles at points of time of the step; one block of all. A wall
  // of 81,920 triangles, a ball and a needle that slide over it, into it and off it.
  geometry::TriangleSurface ball = geometry::make_ball(0.05, 6);
  RandomShapes random(5);
  std::vector<OrganSurface> organs;
  for (const std::size_t most : {std::size_t{40}, ball.triangles.size()}) {
    organs.emplace_back(ball.triangles,
                        geometry::SurfaceBlocks::split(ball.nodes, ball.triangles, most));
    organs.back().update(ball.nodes);
    organs.back().mark_found();
  }
  const std::uint64_t before = organs[0].version();
  for (Vec3& x : ball.nodes) x += 3e-4 * std::sin(90 * x.x()) * Vec3(0.6, 0, 0.8);
  for (OrganSurface& organ : organs) organ.update(ball.nodes);
  std::size_t touched = 0;
  for (const double height : {0.0475, 0.0505, 0.056}) {
    for (const auto& form : {scene::form_of(scene::SphereShape{0.008}),
                             scene::form_of(scene::CapsuleShape{0.006, 0.02})}) {
      const ProbeModel probe(form);
      const Pose start{height * random.direction() + 0.008 * Vec3::UnitZ(), random.rotation()};
      const ProbeMotion way{start, {start.position + random.point(0.001), start.rotation}};
      const RelativeMotion motion(way, probe.reach, probe.is_round);
      std::array<NearSurface, 2> near;
      for (std::size_t i = 0; i < 2; ++i) {
        const OrganStep step{0, organs[i], motion, before, 0.005, 1};
        if (near[i].gather_front(step, probe.cores[0], 0.005)) near[i].sweep_candidates(step);
      }
      const auto& found = near[1].triangles();
      CHECK(same_triangles(near[0].triangles(), found));
      const OrganStep step{0, organs[1], motion, before, 0.005, 1};
      SweptTriangle triangle;
      std::size_t all = 0;
      std::pair nearest(1.0, 0u);
      for (std::uint32_t t = 0; t < ball.triangles.size(); ++t) {
        REQUIRE(step.sweep(t, triangle));
        const double at_end = closest(probe.cores[0], triangle.end).distance;
        nearest = std::min(nearest, std::pair(at_end, t));
        all += at_end <= probe.hull_radius + 0.005;
        bool touches = false;
        for (const double at : {0.0, 0.25, 0.5, 0.75, 1.0}) {
          touches |= closest(probe.cores[0], triangle.at(at)).distance <= probe.hull_radius;
        }
        touched += touches;
        if (touches) CHECK(std::ranges::binary_search(found, t, {}, &SweptTriangle::index));
      }
      if (all == 0) continue;
      CHECK(std::ranges::any_of(found, [&](const SweptTriangle& t) {
        return closest(probe.cores[0], t.end).distance <= nearest.first + 1e-4;
      }));
      if (all > 2 * NearSurface::kManyTriangles) CHECK(found.size() < 0.8 * double(all));
      Bounds there, those;
      for (const SweptTriangle& t : found) there.add(t.end[0]);
      for (std::uint32_t t = 0; t < ball.triangles.size(); ++t) {
        REQUIRE(step.sweep(t, triangle));
        const double at_end = closest(probe.cores[0], triangle.end).distance;
        if (at_end <= probe.hull_radius + 0.005) those.add(triangle.end[0]);
      }
      const double cell = (2 * (probe.hull_radius + 0.005) + 0.02) / double(NearSurface::kCells);
      CHECK((there.lower - those.lower).maxCoeff() < cell);
      CHECK((those.upper - there.upper).maxCoeff() < cell);
    }
  }
  CHECK(touched > 1000);
}

TEST_CASE("near surface: nodes near a half-space, each once") {
  // Oracle: brute force over all nodes.
  SplitOrgans scene;
  scene.move();
  std::size_t found = 0;
  for (int step = 0; step < 30; ++step) {
    const std::uint64_t before = scene.organs[0].version();
    scene.move();
    const ProbeModel plane(scene::form_of(scene::PlaneShape{}));
    const RelativeMotion motion(random_way(scene.random), 0, false);
    for (const OrganSurface& organ : scene.organs) {
      const OrganStep whole{0, organ, motion, before, 0.002, 1};
      NearSurface near;
      std::vector<std::uint32_t> nodes, expected;
      near.gather_nodes(whole, plane.hull, 0.002, nodes);
      std::sort(nodes.begin(), nodes.end());
      for (std::uint32_t i = 0; i < organ.node_count(); ++i) {
        const double height = std::min(whole.node_start(i)[2], whole.node_end(i)[2]);
        if (height <= 0.002 + motion.chord_error()) expected.push_back(i);
      }
      CHECK(nodes == expected);
      found += nodes.size();
    }
  }
  CHECK(found > 1000);
}

TEST_CASE("near surface: triangles are added once and in order") {
  // Oracle: definition.
  SplitOrgans scene;
  scene.move();
  const OrganSurface& organ = scene.organs[1];
  const RelativeMotion motion({{}, {Vec3(0, 0, 1e-3), Quat::Identity()}}, 0.01, true);
  const OrganStep step{0, organ, motion, 0, 0.002, 1};
  NearSurface near;
  const Vec3 x = organ.positions()[0];
  near.gather(step, {x, x}, 0.004);
  const auto indices = [&near] {
    std::vector<std::uint32_t> found;
    for (const SweptTriangle& t : near.triangles()) found.push_back(t.index);
    return found;
  };
  std::vector<std::uint32_t> all = indices();
  REQUIRE(!all.empty());
  const auto next_missing = [&all](std::uint32_t t) {
    while (std::binary_search(all.begin(), all.end(), t)) ++t;
    return t;
  };
  const std::uint32_t low = next_missing(0), high = next_missing(all.front());
  std::vector<std::uint32_t> more{all.back(), high, low, high};
  all.insert(all.end(), {low, high});
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  near.add(step, more);
  CHECK(indices() == all);
  CHECK(near.travel() == Approx(1e-3));
  std::vector<std::uint32_t> nodes, expected;
  near.append_nodes(nodes);
  for (const SweptTriangle& t : near.triangles()) {
    expected.insert(expected.end(), t.nodes.begin(), t.nodes.end());
  }
  std::sort(expected.begin(), expected.end());
  expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
  CHECK(nodes == expected);
  near.clear();
  CHECK(near.triangles().empty());
}

}  // namespace palpate::collision
