#include "modules/core/units.h"

#include <catch2/catch.hpp>
#include <limits>

#include "modules/core/error.h"

using namespace palpate;

TEST_CASE("units: every accepted unit of length has its exact size in metres") {
  // Oracle: the SI prefixes, and the international inch of 1959 (25.4 mm).
  CHECK(metres_per_unit("m") == 1.0);
  CHECK(metres_per_unit("dm") == 0.1);
  CHECK(metres_per_unit("cm") == 0.01);
  CHECK(metres_per_unit("mm") == 0.001);
  CHECK(metres_per_unit("um") == 0.000001);
  CHECK(metres_per_unit("in") == 0.0254);
}

TEST_CASE("units: anything else is refused, listing what is allowed") {
  // Oracle: the message promised in units.h; names near to accepted ones.
  for (const std::string unit : {"", "M", "MM", "inch", " mm", "mm ", "furlong"}) {
    INFO("unit '" << unit << "'");
    CHECK_THROWS_MATCHES(
        metres_per_unit(unit), InputError,
        Catch::Message("unit '" + unit + "' is not known; allowed: m, dm, cm, mm, um, in"));
  }
}

TEST_CASE("units: seconds round to the nearest nanosecond on both sides of zero") {
  // Oracle: hand-computed values, each a clear distance from a tie.
  CHECK(ns_from_seconds(0) == 0);
  CHECK(ns_from_seconds(1) == kNanosecondsPerSecond);
  CHECK(ns_from_seconds(0.001) == 1'000'000);
  CHECK(ns_from_seconds(1.4e-9) == 1);
  CHECK(ns_from_seconds(1.6e-9) == 2);
  CHECK(ns_from_seconds(-1.4e-9) == -1);
  CHECK(ns_from_seconds(-1.6e-9) == -2);
}

TEST_CASE("units: nanoseconds survive the way through seconds and back") {
  // Oracle: the invariant ns → s → ns = identity. A double has 53 bits, so it holds up to 2^51 ns
  // (26 days), where half a nanosecond is still two units in the last place.
  for (const std::int64_t ns : {std::int64_t{1}, std::int64_t{999'999'999}, std::int64_t{1} << 40,
                                (std::int64_t{1} << 51) - 1}) {
    INFO(ns << " ns");
    CHECK(ns_from_seconds(seconds_from_ns(ns)) == ns);
    CHECK(ns_from_seconds(seconds_from_ns(-ns)) == -ns);
  }
}
