#include "visualizer/camera.h"
#include "tests/visualizer/fake_session.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace palpate;
using namespace palpate::visualizer;

TEST_CASE("camera: the frontal camera shows x to the right and z up", "[visualizer][analytic]") {
  // Oracle: analytic; looking along +y.
  const Camera camera = frontal_camera(Vec3(0.1, 0, 0.2), 0.1, 800, 600);
  const auto middle = project(camera, Vec3(0.1, 0, 0.2));
  REQUIRE(middle);
  CHECK(middle->x == Approx(400));
  CHECK(middle->y == Approx(300));
  CHECK(project(camera, Vec3(0.15, 0, 0.2))->x > 400);
  CHECK(project(camera, Vec3(0.1, 0, 0.25))->y > 300);
  CHECK(camera.view_direction().isApprox(Vec3::UnitY()));
}

TEST_CASE("camera: the frontal camera holds the whole ball, and not much more",
          "[visualizer][analytic]") {
  // Oracle: analytic. The outline of a ball seen from distance d has the half angle asin(r/d): it
  // touches the nearer picture edge exactly.
  for (const auto& [width, height] : {std::pair{800, 600}, std::pair{500, 900}}) {
    const double radius = 0.1;
    const Camera camera = frontal_camera(Vec3::Zero(), radius, width, height);
    const double distance = (camera.target - camera.position).norm();
    const double outline = std::tan(std::asin(radius / distance)) / camera.pixel_size(1);
    CHECK(outline == Approx(0.5 * std::min(width, height)));
  }
}

TEST_CASE("camera: unproject is the inverse of project", "[visualizer][analytic]") {
  // Oracle: analytic inverse; double precision.
  const Camera camera = testing::skewed_camera();
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.1, 0.05, -0.1), Vec3(-0.05, 0.2, 0.1)}) {
    const auto pixel = project(camera, p);
    REQUIRE(pixel);
    CHECK((unproject(camera, *pixel) - p).norm() < 1e-12);
  }
}

TEST_CASE("camera: a pixel at the view's upper edge lies at half the view angle",
          "[visualizer][analytic]") {
  // Oracle: trigonometry.
  const Camera camera = testing::skewed_camera();
  const Vec3 p = unproject(camera, {camera.width / 2.0, double(camera.height), 1.0});
  const double angle = std::acos((p - camera.position).normalized().dot(camera.view_direction()));
  CHECK(angle == Approx(0.5 * camera.view_angle));
}

TEST_CASE("camera: points behind the eye have no pixel", "[visualizer]") {
  // Oracle: the stated rule.
  const Camera camera = testing::skewed_camera();
  CHECK_FALSE(project(camera, camera.position - camera.view_direction()));
  CHECK_FALSE(project(camera, camera.position));
}

TEST_CASE("camera: orbit keeps the distance, stays off the poles, and follows the mouse",
          "[visualizer]") {
  // Oracle: invariants of a turn about the target; a point in front of the target moves with the
  // mouse.
  Camera camera = frontal_camera(Vec3::Zero(), 0.1, 800, 600);
  const double distance = camera.position.norm();
  const auto before = project(camera, Vec3(0, -0.1, 0));
  orbit(camera, 30, 20);
  const auto after = project(camera, Vec3(0, -0.1, 0));
  CHECK(camera.position.norm() == Approx(distance));
  CHECK(after->x > before->x);
  CHECK(after->y > before->y);
  for (int i = 0; i < 100; ++i) orbit(camera, 0, 40);
  CHECK(std::abs(camera.view_direction().z()) <= 0.99);
  CHECK(std::isfinite(camera.right().x()));
}

TEST_CASE("camera: pan carries the target's plane along with the mouse", "[visualizer][analytic]") {
  // Oracle: analytic.
  Camera camera = testing::skewed_camera();
  const Vec3 target = camera.target;
  const auto before = project(camera, target);
  pan(camera, 25, -40);
  const auto after = project(camera, target);
  CHECK(after->x - before->x == Approx(25));
  CHECK(after->y - before->y == Approx(-40));
}

TEST_CASE("camera: zoom goes nearer and back, and never through the target", "[visualizer]") {
  // Oracle: inverse operation; the stated least distance.
  Camera camera = testing::skewed_camera();
  const Vec3 position = camera.position;
  zoom(camera, 3);
  CHECK((camera.position - camera.target).norm() < (position - camera.target).norm());
  zoom(camera, -3);
  CHECK((camera.position - position).norm() < 1e-12);
  for (int i = 0; i < 200; ++i) zoom(camera, 5);
  CHECK((camera.position - camera.target).norm() > 0.0099);
}
