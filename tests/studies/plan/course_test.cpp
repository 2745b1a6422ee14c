#include "studies/plan/course.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "modules/geometry/primitives.h"
#include "tests/studies/plan/courses.h"

namespace palpate::plan {
namespace {

using testing::course_to;

TEST_CASE("plan: errors of a course are root mean squares against the reference") {
  // Oracle: by hand.
  const Errors errors = compare(course_to(1.1, 3e-3), course_to(1, 1e-3));
  CHECK(errors.force == Approx(0.1));
  CHECK(errors.surface == Approx(std::sqrt(4e-6 / 4)));
  Course cut = course_to(1, 0);
  cut.forces.pop_back();
  CHECK(std::isinf(compare(cut, course_to(1, 0)).force));
}

TEST_CASE("plan: of a solid the force along the true one is judged, where the probes were held") {
  // Oracle: by hand. True forces of 1 and 2 N, known to 0.1 N; found 1.2 and 2.4 N along them,
  // 0.3 N across, and 0.5 N more in motion at the first.
  TrueTouch first{0.1, {1}, {{Vec3(0, 0, 1)}, {0.1}, {Vec3::Zero()}, 1e-4}};
  TrueTouch second{0.2, {1}, {{Vec3(0, 2, 0)}, {0.1}, {Vec3(1e-3, 0, 0)}, 1e-4}};
  Course course;
  course.held_forces = {{Vec3(9, 9, 9), Vec3(0.3, 0, 1.2)}, {Vec3(9, 9, 9), Vec3(0, 2.4, 0.3)}};
  course.moving_forces = {{Vec3(9, 9, 9), Vec3(0.3, 0, 1.7)}, {Vec3(9, 9, 9), Vec3(0, 2.4, 0.3)}};
  course.held_surfaces = {{Vec3(2e-3, 0, 0)}, {Vec3(1e-3, 0, 0)}};
  const Errors errors = compare(course, std::vector{first, second});
  CHECK(errors.force == Approx(0.2));
  CHECK(errors.force_bar == Approx(0.1 * 1.2));  // where it is worst, errors alike: of 1 N
  CHECK(errors.surface == Approx(std::sqrt(4e-6 / 2)));
  CHECK(errors.surface_bar == Approx(1e-4));
  CHECK(errors.feel.stiffness == Approx(0.2));
  CHECK(errors.feel.uneven == Approx(0).margin(1e-7));
  CHECK(errors.feel.moving == Approx(std::sqrt(0.25 / 5)));
  CHECK(errors.feel.sideways == Approx(std::sqrt(0.18 / 5)));
  course.held_forces.pop_back();
  CHECK(std::isinf(compare(course, std::vector{first, second}).force));
}

TEST_CASE("plan: the worst instant decides, and of light touches a part of the largest force") {
  // Oracle: by hand. Forces of 2, 1 and 0.1 N; 0.1, 0.3 and 0.2 N too much: 5 %, 30 % and, of a
  // fifth of 2 N, 50 %.
  std::vector<TrueTouch> truths;
  Course course;
  for (const auto& [force, more] : {std::pair(2.0, 0.1), {1.0, 0.3}, {0.1, 0.2}}) {
    truths.push_back({0.1, {0}, {{Vec3(0, 0, force)}, {0.01}, {}, 0}});
    course.held_forces.push_back({Vec3(0, 0, force + more)});
  }
  course.moving_forces = course.held_forces;
  course.held_surfaces.resize(3);
  CHECK(compare(course, truths, 1).force == Approx(0.05));
  CHECK(compare(course, truths, 2).force == Approx(0.3));
  CHECK(compare(course, truths).force == Approx(0.5));
  CHECK(compare(course, truths).force_bar == Approx(0.01 / 0.4 * 1.5));
}

TEST_CASE("plan: a course that need not run on ends where somebody says so, and tells why") {
  // Oracle: who is asked; the probe is held once, at 0.3 s, until all is still.
  scene::Scene scene;
  scene.organs.push_back({});
  scene.rates.deformation = scene.rates.collision = 100;
  scene::ScriptedDevice still;
  still.start = Vec3(0, 0, 0.2);
  scene.probes.push_back({"tip", scene::SphereShape{0.01}, 0.0, still});
  const geometry::OrganShape ball(geometry::make_ball(0.05, 2));
  std::size_t asked = 0;
  const auto course = run_course(
      scene, ball, {}, 5, {0.3}, [] {},
      [&](const Course& so_far) {
        ++asked;
        CHECK(so_far.deformation_cost > 0);
        return so_far.held_forces.empty() ? std::string() : std::string("enough");
      });
  CHECK(course.stopped == "enough");
  CHECK(course.held_forces.size() == 1);
  CHECK(asked == 2);  // after 0.25 s, and where it was held
  CHECK(course.time < 0.3 + 1.5 + 0.02);
  CHECK(run_course(scene, ball, {}, 0.2, {}, [] {}).stopped.empty());
}

}  // namespace
}  // namespace palpate::plan
