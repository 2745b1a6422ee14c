// Courses made up for tests.
#pragma once

#include "studies/plan/course.h"

namespace palpate::plan::testing {

/// Two samples of one probe and two marks: nothing, then this force [N] and, at the first mark,
/// this way [m].
inline Course course_to(double force, double way) {
  Course course;
  course.forces = {{Vec3(0, 0, 0)}, {Vec3(0, 0, force)}};
  course.surfaces = {{Vec3::Zero(), Vec3::Zero()}, {Vec3(way, 0, 0), Vec3::Zero()}};
  return course;
}

}  // namespace palpate::plan::testing
