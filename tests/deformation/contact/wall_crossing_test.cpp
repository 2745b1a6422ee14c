#include "deformation/contact/wall_crossing.h"

#include <catch2/catch.hpp>
#include <limits>
#include <numeric>

#include "deformation/contact/surface_walk.h"
#include "tests/collision/random_shapes.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

using collision::RandomShapes;

/// A dented ball that moves and is dented further, and a core that moves to and past it.
struct Passing {
  OrganModel model = testing::ball_model(2);
  SurfaceWalk surface{model};
  std::vector<Vec3> start, end;
  CoreWay core;

  explicit Passing(RandomShapes& random) {
    const double radius = testing::kBallRadius;
    const Vec3 drift = random.point(0.2 * radius);
    start = random.deformed_ball(radius, 2).nodes;
    for (const Vec3& x : start) {
      end.push_back((x + drift + random.point(0.05 * radius)).eval());
    }
    const Vec3 out = random.direction(), half = random.number(0.1, 2) * radius * random.direction();
    const Vec3 from = random.number(0.3, 2) * radius * out;
    const Vec3 to = from - random.number(0, 1.5) * radius * out;
    const Vec3 turn = random.point(0.2 * radius);
    core = {from - half, from + half, to - half - turn, to + half + turn};
  }

  /// Of the core to the wall at an instant [m].
  double distance(double time) const {
    const Vec3 a = core.a0 + time * (core.a1 - core.a0), b = core.b0 + time * (core.b1 - core.b0);
    double nearest = std::numeric_limits<double>::infinity();
    std::vector<Vec3> x(start.size());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = start[i] + time * (end[i] - start[i]);
    for (std::uint32_t t = 0; t < model.triangles.size(); ++t) {
      nearest = std::min(nearest, surface.triangle_near(t, a, b, x).pair.distance);
    }
    return nearest;
  }

  /// Of the first crossing found, by the side or by an end; none: beyond 1.
  double found() {
    std::vector<std::uint32_t> seeds(model.triangles.size());
    std::iota(seeds.begin(), seeds.end(), 0);
    double first = 2;
    std::vector<WallCrossing> crossings;
    surface.find_side_crossings(core, start, end, seeds, crossings);
    for (const WallCrossing& c : crossings) first = std::min(first, c.time);
    for (const auto& [p0, p1] : {std::pair(core.a0, core.a1), std::pair(core.b0, core.b1)}) {
      const auto crossing = surface.first_crossing(p0, p1, start, end, seeds);
      if (crossing) first = std::min(first, crossing->time);
    }
    return first;
  }
};

TEST_CASE("wall crossing: a core's ends and side are seen to go through when they do") {
  // Oracle: brute force: the distance of the core to all triangles at a thousand instants. A core
  // outside that meets the wall within the step is seen when it does, to an instant; one that does
  // not, is not.
  constexpr int kInstants = 1000;
  RandomShapes random(3);
  int met = 0, missed = 0;
  while (met < 60 || missed < 60) {
    Passing passing(random);
    if (!(passing.distance(0) > 1e-3)) continue;
    const Vec3 middle = (passing.core.a0 + passing.core.b0) / 2;
    if (middle.norm() < 0.8 * testing::kBallRadius) continue;  // it lies inside
    int instant = 1;
    double nearest = 1;
    for (; instant <= kInstants && nearest > 0; ++instant) {
      nearest = std::min(nearest, passing.distance(static_cast<double>(instant) / kInstants));
    }
    const double found = passing.found();
    if (nearest == 0) {
      ++met;
      const double time = (instant - 1.0) / kInstants;
      CHECK(found <= time);
      CHECK(found >= time - 2.0 / kInstants);
    } else if (nearest > 1e-3) {
      ++missed;
      CHECK(found > 1);
    }
  }
}

TEST_CASE("wall crossing: where a side goes over an edge both say the same place") {
  // Oracle: analytic: a rod across a roof's ridge, down onto it, tissue coming up. From within, or
  // going away, it is none.
  const auto roof = [](double height) -> EdgeCorners {
    return {Vec3(0, -1, height), Vec3(0, 1, height), Vec3(-1, 0, height - 1),
            Vec3(1, 0, height - 1)};
  };
  const auto rod = [](double from, double to) -> CoreWay {
    return {Vec3(-3, 0.5, from), Vec3(1, 0.5, from), Vec3(-3, 0.5, to), Vec3(1, 0.5, to)};
  };
  const auto crossing = crossing_of_side(rod(0.3, 0), roof(0), roof(0.1));
  REQUIRE(crossing);
  CHECK(crossing->time == Approx(0.75).epsilon(1e-6));
  CHECK(crossing->along == Approx(0.75).epsilon(1e-6));
  CHECK((crossing->weights - Vec3(0.25, 0.75, 0)).norm() < 1e-6);
  CHECK((crossing->normal - Vec3::UnitZ()).norm() < 1e-12);
  CHECK_FALSE(crossing_of_side(rod(-0.3, 0.3), roof(0), roof(0)));
  CHECK_FALSE(crossing_of_side(rod(0.3, 0.1), roof(0), roof(0)));
  // One that sticks through a side of the roof already does not go in over the ridge.
  const CoreWay stuck{Vec3(-2, 0, 3.3), Vec3(1, 0, -1.2), Vec3(-2, 0, 2.7), Vec3(1, 0, -1.8)};
  CHECK_FALSE(crossing_of_side(stuck, roof(0), roof(0)));
}

}  // namespace
}  // namespace palpate::deformation
