#include "modules/core/rotation_vector.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace palpate;

TEST_CASE("rotation vector: exponential agrees with axis and angle") {
  // Oracle: independent tool, Eigen's AngleAxis.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-4, 4);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 v(any(random), any(random), any(random));
    const Quat expected(Eigen::AngleAxisd(v.norm(), v.normalized()));
    CHECK((rotation_from_vector(v).coeffs() - expected.coeffs()).norm() < 1e-15 * 10);
  }
}

TEST_CASE("rotation vector: logarithm inverts the exponential up to half a turn, at any scale") {
  // Oracle: invariant, log(exp(v)) = v for |v| < π; and q, −q are the same rotation.
  const Vec3 axis = Vec3(1, -2, 3).normalized();
  for (const double angle : {0.0, 1e-300, 1e-12, 0.9e-4, 1.1e-4, 0.01, 1.0, 3.0, 3.1415}) {
    const Vec3 v = angle * axis;
    Quat q = rotation_from_vector(v);
    // Near half a turn the cosine's rounding enters; everywhere a few units in the last place.
    CHECK((vector_from_rotation(q) - v).norm() <= 1e-14 * angle);
    q.coeffs() = -q.coeffs();
    CHECK((vector_from_rotation(q) - v).norm() <= 1e-14 * angle);
  }
}

TEST_CASE("rotation between: turns one direction into the other the short way") {
  // Oracle: invariants: b is met, and the angle is that between a and b, up to half a turn; near to
  // it the axis is known as well as rounding allows, b to 1.5e-8. Else a few roundings.
  const Vec3 a(1, -2, 3), across = a.unitOrthogonal();
  for (const Vec3& b : {Vec3(2, 1, 0.5), Vec3(3, -6, 9), Vec3(-1, 2, -3), Vec3(0, 0, 1e-3)}) {
    const Quat turn = rotation_between(a, b);
    CHECK((turn * a.normalized() - b.normalized()).norm() < 1e-14);
    const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
    CHECK(std::abs(vector_from_rotation(turn).norm() - angle) < 1e-14);
  }
  for (const double off : {1e-2, 1e-5, 1e-7, 4e-8, 1e-8, 1e-12}) {
    INFO(off);
    const Vec3 b = -a.normalized() + off * across;
    const Quat turn = rotation_between(a, b);
    CHECK(std::abs(turn.norm() - 1) < 1e-15);
    CHECK((turn * a.normalized() - b.normalized()).norm() < (off > 1.5e-8 ? 2e-15 / off : 1.5e-8));
  }
}
