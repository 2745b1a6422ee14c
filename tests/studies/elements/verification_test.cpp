#include "studies/elements/verification.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "studies/elements/elements_command.h"
#include "studies/elements/load_path.h"
#include "tests/deformation/elements/solids.h"

namespace palpate::elements_bench {
namespace {

Setting quick_setting() {
  return {data_file("reference"), true, [] {}, [](const std::string&) {}};
}

TEST_CASE("verification: a squeezed ball on a coarse octant is near the reference") {
  // Oracle: reference case A, another package. Coarse: 3 % of force, 4 % of the bulge from 5 to 20
  // %.
  if (deformation::testing::without_gmsh()) return;
  const auto run = run_case("A", 0.3, quick_setting());
  CHECK(run.complete);
  REQUIRE(run.rows.size() == 4);
  for (const ErrorRow& row : run.rows) {
    CHECK(row.force == Approx(row.reference_force).epsilon(0.03));
    CHECK(row.bulge == Approx(row.reference_bulge).epsilon(0.04));
  }
}

TEST_CASE("verification: a free ball vibrates as Lamb says") {
  // Oracle: Lamb's exact roots; a coarse ball within 2 % in all families, 0.5 % in the two lowest.
  if (deformation::testing::without_gmsh()) return;
  const auto run = run_case("E", 0.35, quick_setting());
  REQUIRE(run.rows.size() == 7);
  for (const ErrorRow& row : run.rows)
    CHECK(row.force == Approx(row.reference_force).epsilon(0.02));
  for (std::size_t r = 0; r < 2; ++r) {
    CHECK(run.rows[r].force == Approx(run.rows[r].reference_force).epsilon(0.005));
  }
}

TEST_CASE("verification: the command prints errors and orders, and stops when asked") {
  // Oracle: the stated behaviour; an error that falls by 4 when the size halves is of order 2.
  CHECK(observed_order(0.04, -0.01, 0.2, 0.1) == Approx(2));
  std::ostringstream out, log;
  ElementsOptions options;
  options.reference_folder = quick_setting().reference_folder;
  options.cases = {"C"};
  options.sizes = {1};
  options.quick = true;
  if (deformation::testing::without_gmsh()) return;
  CHECK(run_elements(
            options, [] { throw Interrupted("stopped"); }, out, log) == kExitStopped);
  CHECK(log.str() == "stopped\n");
  CHECK(run_elements(
            options, [] {}, out, log) == kExitDone);
  CHECK(out.str().find("2.07533") != std::string::npos);
  options.sizes = {2};
  CHECK_THROWS_AS(run_elements(
                      options, [] {}, out, log),
                  InputError);
  options.sizes = {1};
  options.reference_folder = "/nowhere";
  CHECK_THROWS_WITH(run_elements(
                        options, [] {}, out, log),
                    Catch::Contains("/nowhere/C_block_force_bulge.csv: no such file"));
}

}  // namespace
}  // namespace palpate::elements_bench
