#include "haptics/force_limits.h"

#include <catch2/catch.hpp>

#include "modules/core/touch.h"
#include "tests/haptics/hostile_numbers.h"

using namespace palpate;
using haptics::ForceLimiter;

TEST_CASE("force limits: what is within both limits passes bit for bit") {
  // Oracle: identity.
  ForceLimiter limiter(3.3, 0.2);
  std::uint32_t limits = 0;
  for (const double f : {0.1, 0.25, 0.1, -0.05}) {
    CHECK(limiter.limit(Vec3(f, 0, 0), limits) == Vec3(f, 0, 0));
  }
  CHECK(limits == kForceNotLimited);
}

TEST_CASE("force limits: a jump is approached at the slew rate and ends at the largest force") {
  // Oracle: analytic, 0.2 N per tick up to 3.3 N: 17 ticks.
  ForceLimiter limiter(3.3, 0.2);
  for (int i = 1; i <= 20; ++i) {
    std::uint32_t limits = 0;
    const Vec3 force = limiter.limit(Vec3(0, 0, 10), limits);
    CHECK(force.z() == Approx(std::min(0.2 * i, 3.3)));
    CHECK((limits & kForceSlewLimited) != 0);
    CHECK(((limits & kForceSaturated) != 0) == (i >= 17));
  }
}

TEST_CASE("force limits: a force that is not finite fades to zero at the slew rate") {
  // Oracle: analytic.
  ForceLimiter limiter(3.3, 0.2);
  std::uint32_t limits = 0;
  limiter.limit(Vec3(0.15, 0, 0), limits);
  limiter.limit(Vec3(0.3, 0, 0), limits);
  REQUIRE(limits == kForceNotLimited);
  const Vec3 bad(0, std::nan(""), 0);
  CHECK(limiter.limit(bad, limits).x() == Approx(0.1));
  CHECK((limits & kForceNotFinite) != 0);
  CHECK(limiter.limit(bad, limits).norm() == 0);
}

TEST_CASE("force limits: neither limit is ever exceeded, whatever comes in") {
  // Oracle: invariants |f| ≤ max and |Δf| ≤ rate·T, tolerance 1e-12 of max (rounding).
  const double max = 3.3, step = GENERATE(1e-6, 0.2, 2.0, 100.0);
  haptics::HostileNumbers numbers(17);
  ForceLimiter limiter(max, step);
  for (int i = 0; i < 10'000; ++i) {
    const Vec3 before = limiter.output();
    std::uint32_t limits = 0;
    const Vec3 wanted = numbers.vector();
    const Vec3 after = limiter.limit(wanted, limits);
    REQUIRE(after.allFinite());
    REQUIRE(after.norm() <= max * (1 + 1e-12));
    REQUIRE((after - before).norm() <= step + 1e-12 * max);
    REQUIRE(((limits & kForceNotFinite) != 0) == !wanted.allFinite());
    if (limits == kForceNotLimited) REQUIRE(after == wanted);
  }
}
