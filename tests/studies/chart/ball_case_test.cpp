#include <catch2/catch.hpp>

#include "studies/chart/cases.h"
#include "tests/modules/geometry/tetrahedra.h"
#include "tests/studies/chart/folders.h"
#include "tests/studies/keep_on.h"

namespace palpate::chart {
namespace {

using report::kKeepOn;

TEST_CASE("ball case: calibrated springs carry the force that calibration found") {
  // Oracle: `palpate calibrate`'s table for 642 nodes: −22, −5, 0 and +0.6 % of force at 10 to 40
  // %, by plates that are put onto the nodes without a collision search.
  const auto m = measure(find_case("ball"), {"implicit_volume", 1, 250}, kKeepOn);
  REQUIRE(m.samples.size() == 4);
  const double expected[] = {0.6227, 2.3834, 5.2497, 9.6975};
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(m.samples[i].force == Approx(expected[i]).epsilon(0.02));
}

TEST_CASE("ball case: the real-time model is within 10 % of the force from 10 to 40 %") {
  // Oracle: reference case A.
  if (geometry::testing::without_gmsh()) return;
  const auto m = measure(find_case("ball"), {"nodal_pressure", 0, 100}, kKeepOn);
  REQUIRE(m.samples.size() == 4);
  for (const Sample& sample : m.samples) {
    CHECK(sample.force == Approx(sample.reference_force).epsilon(0.1));
  }
}

TEST_CASE("ball case: corotational tetrahedra lock and soften") {
  // Oracle: reference case A as a bound from both sides: near it for small strains at ν = 0.45, far
  // below it at 40 %.
  if (geometry::testing::without_gmsh()) return;
  const auto m = measure(find_case("ball"), {"corotational", 0, 100}, kKeepOn);
  REQUIRE(m.samples.size() == 4);
  CHECK(m.samples[0].force == Approx(m.samples[0].reference_force).epsilon(0.1));
  CHECK(m.samples[3].force < 0.8 * m.samples[3].reference_force);
}

TEST_CASE("ball case: the ellipsoidal mode of quadratic elements has Lamb's frequency") {
  // Oracle: Lamb's exact root. At 1 ms, period lengthening (ωh)²/3 of backward Euler is 0.15 %; 42
  // corners make the rest.
  if (geometry::testing::without_gmsh()) return;
  const auto m = measure(find_case("vibration"), {"modal", 0, 1000}, kKeepOn);
  CHECK(force_error(m) < 0.05);
}

}  // namespace
}  // namespace palpate::chart
