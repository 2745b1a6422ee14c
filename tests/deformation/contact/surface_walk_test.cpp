#include "deformation/contact/surface_walk.h"

#include <catch2/catch.hpp>

#include "tests/collision/random_shapes.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

using collision::RandomShapes;

struct Wall {
  OrganModel model = testing::ball_model(3);
  std::vector<Vec3> x = model.rest_positions;
  SurfaceWalk surface{model};
};

TEST_CASE("surface walk: from any seed it finds what brute force finds") {
  // Oracle: brute force over all triangles of a ball, near which the nearest is reached downhill
  // and what is within a reach is connected.
  Wall wall;
  RandomShapes random(5);
  std::vector<NearTriangle> near;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 out = random.direction();
    const Vec3 a = random.number(0.9, 1.3) * 0.05 * out;
    const Vec3 b = trial % 2 == 0 ? a : Vec3(a + 0.005 * random.direction());
    const double reach = random.number(0, 0.02);
    const auto seed =
        static_cast<std::uint32_t>(random.number(0, double(wall.model.triangles.size() - 1)));
    wall.surface.find(a, b, wall.x, std::span(&seed, 1), reach, near);
    if (a == b) {
      const auto to_a = [&](const Vec3& x) { return (x - a).norm(); };
      const auto node = std::ranges::min_element(wall.x, {}, to_a) - wall.x.begin();
      CHECK(wall.surface.nearest_node(a, b, wall.x) == node);
    }
    double nearest = 1;
    std::size_t within = 0;
    std::vector<std::uint32_t> all_within, appended;
    for (std::uint32_t t = 0; t < wall.model.triangles.size(); ++t) {
      const double d = wall.surface.triangle_near(t, a, b, wall.x).pair.distance;
      nearest = std::min(nearest, d);
      within += d <= reach;
      if (d <= reach) all_within.push_back(t);
    }
    wall.surface.append_near(a, b, wall.x, reach, appended);
    CHECK(appended == all_within);
    REQUIRE_FALSE(near.empty());
    CHECK(near.size() == std::max<std::size_t>(within, 1));
    CHECK(std::ranges::min(near, {}, [](const NearTriangle& n) {
            return n.pair.distance;
          }).pair.distance == nearest);
    CHECK(std::ranges::is_sorted(near, {}, &NearTriangle::index));
  }
}

TEST_CASE("surface walk: a core that lies through triangles is cut by one of them") {
  // Oracle: brute force, the distance of the core to each triangle.
  Wall wall;
  RandomShapes random(7);
  int cuts = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 a = random.number(0.9, 1.2) * 0.05 * random.direction();
    const Vec3 b = a + 0.02 * random.direction();
    std::vector<std::uint32_t> near;
    wall.surface.append_near(a, b, wall.x, 1e-3, near);
    const bool cut = std::ranges::any_of(near, [&](std::uint32_t t) {
      return wall.surface.triangle_near(t, a, b, wall.x).pair.distance == 0;
    });
    cuts += cut;
    if (near.empty()) continue;
    CHECK(wall.surface.is_cut(a, b, wall.x, std::span(near).first(1), 1e-3) == cut);
  }
  CHECK(cuts > 20);
  CHECK(cuts < 180);
}

TEST_CASE("surface walk: the side of the nearest triangle is the point's") {
  // Oracle: analytic; the faces of a ball are within 3 % of its radius of the sphere.
  Wall wall;
  const double radius = wall.x[0].norm();
  RandomShapes random(6);
  std::vector<NearTriangle> near;
  const std::uint32_t seed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const bool inside = trial % 2 == 0;
    const Vec3 p = radius * (inside ? random.number(0.5, 0.95) : random.number(1.01, 1.5)) *
                   random.direction();
    wall.surface.find(p, p, wall.x, std::span(&seed, 1), 0, near);
    CHECK(is_behind_nearest(near) == inside);
  }
}

TEST_CASE(
    "surface walk: a way into a moving wall is found, one along with it or out of it is not") {
  // Oracle: analytic; where a straight way meets the ball, while all of it moves.
  Wall wall;
  const double radius = wall.x[0].norm();
  RandomShapes random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 out = random.direction(), drift = random.point(0.5 * radius);
    const double from = random.number(1.05, 1.5) * radius, to = random.number(-0.5, 0.9) * radius;
    auto end = wall.x;
    for (Vec3& x : end) x += drift;
    std::uint32_t seed = 0;  // the triangle nearest to the way's outer end
    for (std::uint32_t t = 0; t < wall.model.triangles.size(); ++t) {
      const auto distance = [&](std::uint32_t i) {
        return wall.surface.triangle_near(i, from * out, from * out, wall.x).pair.distance;
      };
      if (distance(t) < distance(seed)) seed = t;
    }
    const auto crossed = [&](const Vec3& p0, const Vec3& p1) {
      return wall.surface.first_crossing(p0, p1, wall.x, end, std::span(&seed, 1));
    };
    const auto found = crossed(from * out, to * out + drift);
    REQUIRE(found);
    CHECK(found->time == Approx((from - radius) / (from - to)).margin(0.03 * radius / (from - to)));
    CHECK(found->normal.dot(out) > 0.9);
    Vec3 place = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      place += found->weights[k] *
               wall.x[wall.model.triangles[found->triangle][static_cast<std::size_t>(k)]];
    }
    CHECK(place.cross(out).norm() < 1e-6);
    CHECK_FALSE(crossed(from * out, from * out + drift));
    CHECK_FALSE(crossed(to * out, from * out + drift));
  }
}

}  // namespace
}  // namespace palpate::deformation
