#include "visualizer/probe_drag.h"
#include "tests/visualizer/fake_session.h"

#include <catch2/catch.hpp>

using namespace palpate;
using namespace palpate::visualizer;

TEST_CASE("drag: the probe stays under the cursor and in its plane", "[visualizer][analytic]") {
  // Oracle: analytic projection. The pixel of the probe moves by the mouse's way, its depth not.
  const Camera camera = testing::skewed_camera();
  ProbeDrag drag(1, Vec3(0.05, 0.02, 0.03));
  const auto before = project(camera, drag.position());
  drag.in_picture_plane(camera, 37, -12);
  drag.in_picture_plane(camera, -5, 50);
  const auto after = project(camera, drag.position());
  CHECK(after->x == Approx(before->x + 32));
  CHECK(after->y == Approx(before->y + 38));
  CHECK(after->depth == Approx(before->depth));
}

TEST_CASE("drag: a frontal camera moves it by pixels times the plane's pixel size",
          "[visualizer][analytic]") {
  // Oracle: trigonometry: at depth d one pixel is 2 d tan(angle / 2) / height.
  const Camera camera = frontal_camera(Vec3::Zero(), 0.1, 900, 700);
  ProbeDrag drag(0, Vec3(0, -0.05, 0));
  const double depth = -0.05 - camera.position.y();
  const double pixel = 2 * depth * std::tan(camera.view_angle / 2) / 700;
  drag.in_picture_plane(camera, 100, 40);
  CHECK((drag.position() - Vec3(100 * pixel, -0.05, 40 * pixel)).norm() < 1e-12);
  drag.along_view(camera, 10);
  CHECK((drag.position() - Vec3(100 * pixel, -0.05 + 10 * pixel, 40 * pixel)).norm() < 1e-12);
}

TEST_CASE("drag: towards the eye it stops in front of it", "[visualizer]") {
  // Oracle: the stated rule.
  const Camera camera = testing::skewed_camera();
  ProbeDrag drag(0, Vec3::Zero());
  for (int i = 0; i < 100; ++i) drag.along_view(camera, -100);
  const auto pixel = project(camera, drag.position());
  REQUIRE(pixel);
  CHECK(pixel->depth == Approx(0.02));
}

TEST_CASE("pick: the nearest of the handles under the cursor", "[visualizer]") {
  // Oracle: brute force by construction: two balls in line of sight, one beside.
  const Camera camera = frontal_camera(Vec3::Zero(), 0.1, 900, 700);
  const std::vector<Handle> handles{
      {Vec3(0, 0.05, 0), 0.01}, {Vec3(0, -0.05, 0), 0.01}, {Vec3(0.06, 0, 0), 0.01}};
  CHECK(pick(camera, handles, 450, 350) == std::size_t{1});
  const auto beside = project(camera, handles[2].center);
  CHECK(pick(camera, handles, beside->x, beside->y) == std::size_t{2});
  CHECK_FALSE(pick(camera, handles, 10, 10));
  CHECK_FALSE(pick(camera, {{camera.position - camera.view_direction(), 0.01}}, 450, 350));
}

TEST_CASE("pick: reaches to the handle's edge and the margin, no further",
          "[visualizer][analytic]") {
  // Oracle: analytic outline in pixels.
  const Camera camera = frontal_camera(Vec3::Zero(), 0.1, 900, 700);
  const std::vector<Handle> handles{{Vec3::Zero(), 0.02}};
  const double outline = 0.02 / camera.pixel_size(project(camera, Vec3::Zero())->depth);
  CHECK(pick(camera, handles, 450 + outline + 3.9, 350, 4));
  CHECK_FALSE(pick(camera, handles, 450 + outline + 4.1, 350, 4));
}
