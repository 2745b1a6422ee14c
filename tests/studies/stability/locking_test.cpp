#include "studies/stability/locking.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "tests/studies/chart/folders.h"
#include "tests/studies/keep_on.h"

namespace palpate::stability {
namespace {

using report::kKeepOn;

TEST_CASE("locking: linear tetrahedra stiffen towards one half, averaged pressures do not") {
  // Oracle: recorded reference, A_ball_plates.csv: 0.799225 N at 10 %, ν = 0.499; 1 % for the
  // coarse mesh. Then the theory of locking: nodal_pressure keeps its error within a tenth.
  const double reference = locking_reference(0.499, kKeepOn);
  CHECK(reference == Approx(0.799225).epsilon(0.01));
  const double linear = locking_point("corotational", 0.499, kKeepOn).force;
  const double averaged = locking_point("nodal_pressure", 0.499, kKeepOn).force;
  CHECK(linear > 1.3 * reference);
  CHECK(averaged < 1.1 * reference);
  CHECK(averaged > 0.9 * reference);
  // Quadratic tetrahedra feel that flat facets lie inside the ball, a tenth of what the plates
  // close by: they are too soft, at any ν as much.
  const double near_half = locking_point("quadratic_pressure", 0.499, kKeepOn).force / reference;
  const double below =
      locking_point("quadratic_pressure", 0.45, kKeepOn).force / locking_reference(0.45, kKeepOn);
  CHECK(near_half == Approx(below).margin(0.05));
}

TEST_CASE("locking: what was measured is not measured again, and stands in the table") {
  // Oracle: a second call that is stopped at the first measurement finishes all the same.
  const chart::testing::WorkFolder folder;
  struct Stop {};
  CHECK(locking_ratios(true).size() < locking_ratios(false).size());
  report::Claims claims(folder.path / "claims", {});
  std::ostringstream log;
  const report::PointFiles files(folder.path, log);
  const auto measure = [&](const KeepGoing& keep_going) {
    std::vector<LockingPoint> results;
    report::measure_points(locking_points({0.45}, files, keep_going, results), claims);
    return results;
  };
  CHECK_THROWS_AS(measure([] { throw Stop{}; }), Stop);
  const auto first = measure(kKeepOn);
  const auto again = measure([] { throw Stop{}; });
  REQUIRE(again.size() == first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    CHECK(again[i].error() == first[i].error());
  }
  for (const LockingPoint& point : again) CHECK(point.computed_poisson_ratio == 0.45);
  std::filesystem::resize_file(folder.path / "locking-corotational-0.45-v1.csv", 20);
  CHECK_THROWS_AS(measure([] { throw Stop{}; }), Stop);
  CHECK_THAT(log.str(), Catch::Contains("locking-corotational-0.45-v1.csv: was cut"));
  write_locking(again, folder.path / "locking.csv");
  CHECK(std::filesystem::file_size(folder.path / "locking.csv") > 0);
}

}  // namespace
}  // namespace palpate::stability
