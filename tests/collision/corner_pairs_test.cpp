#include "collision/corner_pairs.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "modules/geometry/closest_points.h"
#include "tests/collision/step_scene.h"

namespace palpate::collision {
namespace {

/// A ball of 20 mm, of a mesh, and one of 50 mm below it as an organ.
struct Balls {
  ProbeModel probe;
  StepScene scene;
  std::vector<SweptTriangle> triangles = scene.triangles();
  CornerPairs pairs;

  Balls(int halvings, double apart, int halvings_of_organ, double margin,
        const Vec3& way = Vec3::Zero())
      : probe(geometry::ProbeForm(geometry::make_ball(0.02, halvings))),
        scene(ball_below(apart, halvings_of_organ), way, margin) {}

  static geometry::TriangleSurface ball_below(double apart, int halvings) {
    auto result = geometry::make_ball(0.05, halvings);
    for (Vec3& x : result.nodes) x.z() -= apart;
    return result;
  }
  std::uint32_t corners() const {
    return static_cast<std::uint32_t>(probe.sharp->vertices().size());
  }
  bool are_too_many() { return pairs.are_too_many(scene.step, probe, triangles); }
  void list() { pairs.list(scene.step, probe, triangles); }
  double distance(const CornerPairs::Pair& pair) const {
    const Vec3& x = probe.sharp->vertices()[pair.first];
    return (x - geometry::closest_on_triangle(x, triangles[pair.second].end).point).norm();
  }
};

}  // namespace

TEST_CASE("corner pairs: of few, each that may come near is there once") {
  // Oracle: brute force over all pairs.
  Balls balls(2, 0.071, 3, 0.004, {0, 0.002, 0.001});
  CHECK_FALSE(balls.are_too_many());
  balls.list();
  const auto found = balls.pairs.pairs();
  REQUIRE_FALSE(found.empty());
  CHECK(std::is_sorted(found.begin(), found.end()));
  CHECK(std::adjacent_find(found.begin(), found.end()) == found.end());
  std::size_t near = 0;
  for (std::uint32_t corner = 0; corner < balls.corners(); ++corner) {
    for (std::uint32_t t = 0; t < balls.triangles.size(); ++t) {
      if (balls.distance({corner, t}) > balls.scene.step.margin) continue;
      ++near;
      CHECK(std::binary_search(found.begin(), found.end(), CornerPairs::Pair{corner, t}));
    }
  }
  CHECK(near > 20);
  CHECK_FALSE(balls.pairs.was_cut());
}

TEST_CASE("corner pairs: of many, each triangle has its nearest corners") {
  // Oracle: brute force over all corners.
  Balls balls(5, 0.071, 3, 0.02);
  CHECK_FALSE(balls.are_too_many());
  balls.list();
  CHECK(balls.pairs.pairs().size() <= CornerPairs::kManyPairs);
  const std::size_t of_each = CornerPairs::kManyPairs / balls.triangles.size();
  REQUIRE(of_each >= CornerPairs::kFewestOfEach);
  std::size_t full = 0;
  for (std::uint32_t t = 0; t < balls.triangles.size(); t += 37) {
    std::vector<double> found, all;
    for (const auto& pair : balls.pairs.pairs()) {
      if (pair.second == t) found.push_back(balls.distance(pair));
    }
    for (std::uint32_t corner = 0; corner < balls.corners(); ++corner) {
      const double of_corner = balls.distance({corner, t});
      if (of_corner <= balls.scene.step.margin) all.push_back(of_corner);
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
  Balls balls(3, 0.071, 5, 0.2);
  CHECK(balls.are_too_many());
  balls.list();
  CHECK(balls.pairs.pairs().size() == CornerPairs::kFewestOfEach * balls.triangles.size());
  const ProbeModel box{geometry::ProbeForm(geometry::Box{Vec3(0.02, 0.02, 0.02)})};
  CHECK_FALSE(balls.pairs.are_too_many(balls.scene.step, box, balls.triangles));
  balls.pairs.list(balls.scene.step, box, balls.triangles);
  CHECK(balls.pairs.pairs().size() == 8 * balls.triangles.size());
}

TEST_CASE("corner pairs: of very many corners behind walls each has what is nearest to it") {
  // Oracle: brute force over all triangles; all corners are inside.
  Balls balls(4, 0.02, 4, 0.002);
  CoreContacts cores;
  cores.begin_step();
  for (std::uint32_t i = 0; i < balls.corners(); ++i) {
    REQUIRE(cores.hold_if_inside(balls.scene.step, balls.probe.core(i)));
  }
  std::vector<std::uint32_t> walls;
  balls.pairs.hold(balls.scene.step, balls.probe, cores, walls);
  CHECK(walls.size() == CornerPairs::kLeastWall * balls.corners());
  CHECK(cores.wall_was_cut());
  balls.list();
  for (std::uint32_t corner = 0; corner < balls.corners(); corner += 17) {
    double nearest = 1, found = 1;
    for (std::uint32_t t = 0; t < balls.triangles.size(); ++t) {
      nearest = std::min(nearest, balls.distance({corner, t}));
    }
    for (const auto& pair : balls.pairs.pairs()) {
      if (pair.first == corner) found = std::min(found, balls.distance(pair));
    }
    CHECK(found == nearest);
  }
}

}  // namespace palpate::collision
