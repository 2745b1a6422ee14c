#include "modules/core/tolerances.h"

#include <catch2/catch.hpp>
#include <limits>

namespace palpate {

TEST_CASE("tolerances: a direction normalised in single precision is a unit vector") {
  // Oracle: float's rounding, on directions all over the sphere; and the tolerance itself.
  for (int k = 0; k < 1000; ++k) {
    const Vec3 direction(std::sin(k), std::cos(3.0 * k), std::sin(7.0 * k + 1));
    const Eigen::Vector3f single = direction.cast<float>().normalized();
    REQUIRE(is_unit(Vec3(single.cast<double>())));
  }
  CHECK(is_unit(Vec3((1 + 0.9e-6) * Vec3::UnitX())));
  CHECK_FALSE(is_unit(Vec3((1 + 1.1e-6) * Vec3::UnitX())));
  CHECK_FALSE(is_unit(Vec3::Zero().eval()));
}

TEST_CASE("tolerances: a pose is believed if it is finite, near and turned by a rotation") {
  // Oracle: the stated rules, one violated at a time.
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const Quat identity = Quat::Identity();
  CHECK(is_believable({Vec3(1, 2, 3), identity}));
  CHECK(is_believable({Vec3(0, 999, 0), Quat(0.6, 0, 0.8, 0)}));
  CHECK_FALSE(is_believable({Vec3(kNaN, 0, 0), identity}));
  CHECK_FALSE(is_believable({Vec3(0, HUGE_VAL, 0), identity}));
  CHECK_FALSE(is_believable({Vec3(0, 1001, 0), identity}));
  CHECK_FALSE(is_believable({Vec3(1e300, 1e300, 0), identity}));
  CHECK_FALSE(is_believable({Vec3::Zero(), Quat(kNaN, 0, 0, 0)}));
  CHECK_FALSE(is_believable({Vec3::Zero(), Quat(0, 0, 0, 0)}));
  CHECK_FALSE(is_believable({Vec3::Zero(), Quat(2, 0, 0, 0)}));
  CHECK_FALSE(is_believable({Vec3::Zero(), Quat(1e200, 1e200, 0, 0)}));
}

}  // namespace palpate
