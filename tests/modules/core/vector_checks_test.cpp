#include "modules/core/vector_checks.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace palpate;

TEST_CASE("clamp_length: shorter vectors pass bit for bit, longer ones keep their direction") {
  // Oracle: analytic, 3-4-5 triangle.
  const Vec3 v(3, 0, -4);
  CHECK(clamp_length(v, 5) == v);
  CHECK(clamp_length(v, 6) == v);
  // Tolerance: four roundings of numbers of order 1.
  CHECK((clamp_length(v, 2.5) - Vec3(1.5, 0, -2)).norm() < 1e-15);
  CHECK(clamp_length(Vec3::Zero(), 0) == Vec3::Zero());
  CHECK(clamp_length(v, 0).norm() == 0);
}

TEST_CASE("clamp_length: numbers whose squares overflow or vanish are still clamped") {
  // Oracle: analytic, the direction (1, 1, 1)/√3 at any scale.
  const double huge = std::numeric_limits<double>::max();
  const double tiny = std::numeric_limits<double>::denorm_min();
  CHECK((clamp_length(Vec3::Constant(huge), 3) - Vec3::Constant(std::sqrt(3.0))).norm() < 1e-14);
  CHECK(clamp_length(Vec3::Constant(tiny), 3) == Vec3::Constant(tiny));
  CHECK(is_longer_than(Vec3(1e-200, 0, 0), 1e-201));
  CHECK_FALSE(is_longer_than(Vec3(1e-200, 0, 0), 1e-199));
}
