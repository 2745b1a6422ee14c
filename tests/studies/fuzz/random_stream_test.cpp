#include "studies/fuzz/random_stream.h"

#include <catch2/catch.hpp>

namespace palpate::fuzz {
namespace {

TEST_CASE("random stream: the same numbers again, others for other streams, all in range") {
  // Oracle: invariants; the mean of 10,000 uniform numbers has a deviation of 0.0029.
  RandomStream a(1, 2), b(1, 2), other(1, 3);
  double sum = 0;
  bool differs = false;
  for (int i = 0; i < 10000; ++i) {
    const double x = a.uniform(0, 1);
    REQUIRE(x == b.uniform(0, 1));
    REQUIRE((x >= 0 && x < 1));
    differs |= x != other.uniform(0, 1);
    sum += x;
  }
  CHECK(differs);
  CHECK(sum / 10000 == Approx(0.5).margin(0.0145));  // five deviations
  for (int i = 0; i < 100; ++i) {
    const double x = a.log_uniform(1e-3, 1e3);
    CHECK((x >= 1e-3 && x <= 1e3));
    CHECK(a.below(7) < 7);
    CHECK(a.direction().norm() == Approx(1));
    CHECK(a.rotation().norm() == Approx(1));
  }
}

}  // namespace
}  // namespace palpate::fuzz
