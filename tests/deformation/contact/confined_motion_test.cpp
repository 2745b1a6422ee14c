#include "deformation/contact/confined_motion.h"

#include <catch2/catch.hpp>
#include <random>

#include "modules/geometry/primitives.h"
#include "modules/geometry/self_intersection.h"

namespace palpate::deformation {
namespace {

/// Surfaces that move by given ways, with all pairs that may meet.
struct Motion {
  std::vector<geometry::TriangleSurface> shapes;
  std::vector<Body> bodies;
  std::vector<std::vector<Vec3>> ends;
  std::vector<StepPair> pairs;
  std::vector<MovingSurface> surfaces;

  explicit Motion(std::vector<geometry::TriangleSurface> rest) : shapes(std::move(rest)) {
    for (const auto& shape : shapes) {
      Body body;
      for (std::size_t i = 0; i < shape.nodes.size(); ++i) {
        body.masses.push_back(1e-3 * static_cast<double>(1 + i % 3));
        body.inverse_masses.push_back(1 / body.masses.back());
      }
      bodies.push_back(std::move(body));
      ends.push_back(shape.nodes);
    }
  }

  Confinement confine(double travel = 1, double reach = 1) {
    std::vector<std::vector<geometry::Triangle>> triangles;
    std::vector<std::span<const Vec3>> positions;
    for (const auto& shape : shapes) {
      triangles.push_back(shape.triangles);
      positions.emplace_back(shape.nodes);
    }
    collision::NearFeatures features(std::move(triangles), {true, true});
    features.search(positions, reach);
    for (const auto& near : features.pairs()) {
      StepPair step{near.pair, {}, {}};
      for (std::size_t k = 0; k < 4; ++k) {
        step.start[k] = shapes[near.pair.surface_of(k)].nodes[near.pair.nodes[k]];
      }
      step.separation = collision::separation_of(near.pair.is_edges, step.start);
      pairs.push_back(step);
    }
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      surfaces.push_back(
          {&bodies[i], shapes[i].nodes, shapes[i].nodes, ends[i], Vec3::Zero(), travel});
    }
    return confine_motion(pairs, surfaces);
  }

  Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      for (std::size_t k = 0; k < ends[i].size(); ++k)
        sum += bodies[i].masses[k] * (ends[i][k] - shapes[i].nodes[k]);
    }
    return sum;
  }
  double energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      for (std::size_t k = 0; k < ends[i].size(); ++k)
        sum += bodies[i].masses[k] * (ends[i][k] - shapes[i].nodes[k]).squaredNorm();
    }
    return sum;
  }

  /// Triangles that pass through each other at some of many times within the step.
  bool crosses() const {
    for (int look = 0; look <= 20; ++look) {
      geometry::TriangleSurface all;
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        const auto shift = static_cast<std::uint32_t>(all.nodes.size());
        for (const auto& [a, b, c] : shapes[i].triangles)
          all.triangles.push_back({a + shift, b + shift, c + shift});
        for (std::size_t k = 0; k < ends[i].size(); ++k) {
          all.nodes.push_back(shapes[i].nodes[k] + look / 20.0 * (ends[i][k] - shapes[i].nodes[k]));
        }
      }
      if (!geometry::find_self_intersections(all).empty()) return true;
    }
    return false;
  }
};

Motion two_balls(double gap) {
  std::vector<geometry::TriangleSurface> balls{geometry::make_ball(0.05, 2),
                                               geometry::make_ball(0.05, 2)};
  for (Vec3& x : balls[1].nodes) x += Vec3(0.1 + gap, 0, 0);
  return Motion(std::move(balls));
}

TEST_CASE("confined motion: what does not meet is not touched") {
  // Oracle: the ends asked for.
  Motion motion = two_balls(1e-3);
  for (Vec3& x : motion.ends[0]) x += Vec3(-0.01, 0.02, 0);
  const auto asked = motion.ends;
  CHECK(motion.confine(1, 0.03) == Confinement::kNone);
  CHECK(motion.ends == asked);
}

TEST_CASE("confined motion: nothing passes through anything, momentum is kept and energy falls") {
  // Oracle: brute force over all triangles at 21 times of the step; sums over the nodes.
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> any(-1, 1);
  int zones = 0;
  for (int run = 0; run < 30; ++run) {
    Motion motion = two_balls(1e-3);
    const double speed = 2e-3 * (1 + run % 5), noise = 1e-3 * (run % 4);
    for (std::size_t i = 0; i < 2; ++i) {
      for (Vec3& x : motion.ends[i]) {
        x += Vec3((i == 0 ? 1 : -1) * speed, 0, 0) +
             noise * Vec3(any(engine), any(engine), any(engine));
      }
    }
    CHECK(motion.crosses());
    const Vec3 momentum = motion.momentum();
    const double energy = motion.energy();
    const Confinement confined = motion.confine(1, 0.04);
    INFO("run " << run << ", " << static_cast<int>(confined));
    REQUIRE((confined == Confinement::kZones || confined == Confinement::kHeld));
    CHECK_FALSE(motion.crosses());
    CHECK(motion.energy() < energy);
    if (confined == Confinement::kZones) {
      ++zones;
      CHECK((motion.momentum() - momentum).norm() < 1e-15);
    }
  }
  CHECK(zones > 15);
}

TEST_CASE("confined motion: a zone with a fixed node stays") {
  // Oracle: the wall.
  Motion motion = two_balls(1e-3);
  for (double& inverse : motion.bodies[1].inverse_masses) inverse = 0;
  for (Vec3& x : motion.ends[0]) x += Vec3(5e-3, 0, 0);
  CHECK(motion.confine(1, 0.02) == Confinement::kZones);
  CHECK_FALSE(motion.crosses());
  CHECK(motion.ends[1] == motion.shapes[1].nodes);
}

TEST_CASE("confined motion: a node beyond the travel that pairs were looked for is told") {
  // Oracle: definition.
  Motion motion = two_balls(1e-3);
  motion.ends[0][3] += Vec3(0, 0.02, 0);
  CHECK(motion.confine(0.01, 0.02) == Confinement::kIncomplete);
  motion.ends[0][3] = Vec3::Constant(std::nan(""));
  CHECK(farthest_travel(motion.shapes[0].nodes, motion.ends[0]) ==
        std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace palpate::deformation
