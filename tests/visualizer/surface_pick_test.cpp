#include "visualizer/surface_pick.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "modules/geometry/primitives.h"
#include "tests/visualizer/fake_session.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::topology_of;
using visualizer::testing::two_probe_scene;

namespace {

constexpr double kRadius = 0.05;
/// A triangulated ball of three levels lies inside the ball by at most this part of its radius: the
/// sagitta of an edge of 0.155 radii.
constexpr double kFlatness = 0.004;

SceneView ball_view() {
  SceneView view(two_probe_scene());
  view.receive(topology_of(geometry::make_ball(kRadius, 3)));
  return view;
}

}  // namespace

TEST_CASE("surface pick: the near side of a ball, where the line of sight meets it",
          "[visualizer][analytic]") {
  // Oracle: a ball and a line.
  const SceneView view = ball_view();
  const Camera camera = frontal_camera(Vec3::Zero(), 0.1, 900, 700);
  const auto hit = pick_surface(view, camera, 450, 350);
  REQUIRE(hit);
  CHECK((hit->point - Vec3(0, -kRadius, 0)).norm() < kFlatness * kRadius);
  CHECK(hit->normal.y() < -0.98);
  CHECK(hit->organ == 0);
  const auto pixel = project(camera, Vec3(0.02, -0.04, 0.02));
  const auto aside = pick_surface(view, camera, pixel->x, pixel->y);
  REQUIRE(aside);
  CHECK(std::abs(aside->point.norm() - kRadius) < kFlatness * kRadius);
  const auto seen = project(camera, aside->point);
  CHECK(seen->x == Approx(pixel->x));
  CHECK(seen->y == Approx(pixel->y));
  CHECK_FALSE(pick_surface(view, camera, 5, 5));
}

TEST_CASE("surface pick: a way meets a ball only where it comes to it", "[visualizer][analytic]") {
  // Oracle: a ball and segments.
  const SceneView view = ball_view();
  CHECK(first_on_way(view, Vec3(-1, 0, 0), Vec3(1, 0, 0)));
  CHECK_FALSE(first_on_way(view, Vec3(-1, 0, 0), Vec3(-0.06, 0, 0)));
  CHECK_FALSE(first_on_way(view, Vec3(-1, 0, 0.06), Vec3(1, 0, 0.06)));
}

TEST_CASE("surface pick: the foot of a point lies below it", "[visualizer][analytic]") {
  // Oracle: a ball; what is inside has its foot outwards.
  const SceneView view = ball_view();
  for (const Vec3& from : {Vec3(0.03, -0.07, 0.02), Vec3(-0.1, 0.01, 0), Vec3(0.01, 0.04, 0.01)}) {
    const auto foot = foot_on_surface(view, from);
    REQUIRE(foot);
    CHECK((foot->point - kRadius * from.normalized()).norm() < 0.1 * kRadius);
    CHECK((foot->point - from).norm() <= std::abs(from.norm() - kRadius) + 2 * kFlatness * kRadius);
  }
  CHECK_FALSE(foot_on_surface(SceneView(two_probe_scene()), Vec3::Zero()));
}
