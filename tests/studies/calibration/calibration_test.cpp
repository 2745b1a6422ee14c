// The parts of the fit, on data whose answer is known.
#include "studies/calibration/calibration.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "modules/core/error.h"
#include "studies/calibration/report.h"
#include "studies/report/progress.h"
#include "tests/scratch_folder.h"

namespace palpate::calibration {
namespace {

using Catch::Matchers::Contains;

const ReferenceColumns kColumns{"c", "f", "p", "r"};

TEST_CASE("calibration: a reference table is read by its columns' names") {
  // Oracle: the numbers written.
  const ScratchFolder folder;
  const auto table =
      folder.write("table.csv", "r,c,other,p,f\n50,0.05,x,1,2\n60,0.5,y,988.4,6.25\n");
  const auto rows = read_reference(table, kColumns, 0.1);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].compression == 0.5);
  CHECK(rows[0].force == 6.25);
  CHECK(rows[0].pressure == 988.4);
  CHECK(rows[0].equatorial_radius == Approx(0.06));
}

TEST_CASE("calibration: a bad reference table is refused with its place") {
  // Oracle: the message text.
  const ScratchFolder folder;
  const auto read = [&](const std::string& text) {
    return read_reference(folder.write("table.csv", text), kColumns, 0.1);
  };
  CHECK_THROWS_WITH(read("c,f,r\n"), Contains(":1: has no column 'p'"));
  CHECK_THROWS_WITH(read("c,f,p,r\n0.1,1,1,50\n0.2,-1,1,50\n"),
                    Contains(":3: column 'f' = '-1': must be a positive number"));
  CHECK_THROWS_WITH(read("c,f,p,r\n0.2,1,nan,50\n"), Contains("'p' = 'nan'"));
  CHECK_THROWS_WITH(read("c,f,p,r\n0.2,1\n"), Contains("'p' = ''"));
  CHECK_THROWS_WITH(read("c,f,p,r\n0.05,1,1,50\n"), Contains("no row"));
  CHECK_THROWS_AS(read_reference("no_such_file.csv", kColumns, 0.1), InputError);
}

/// A model that answers `force_ratio` times the reference in force and pressure.
Comparison answer(const std::vector<ReferenceRow>& rows, double force_ratio, double radius_ratio) {
  Comparison comparison{1, {}};
  for (const auto& row : rows) {
    comparison.equilibria.push_back({row.compression, force_ratio * row.force,
                                     force_ratio * row.pressure.value_or(0),
                                     radius_ratio * row.equatorial_radius, true});
  }
  return comparison;
}

const std::vector<ReferenceRow> kRows{{0.1, 0.2, 30.0, 0.0503}, {0.5, 6.0, 990.0, 0.0615}};

TEST_CASE("calibration: the scale of a model too stiff by a quarter is 0.8") {
  // Oracle: analytic. With the same ratio everywhere nothing is left; a radius 2 % too large in
  // a third of the residuals leaves 2 %/√3.
  const auto exact = best_scale({answer(kRows, 1.25, 1)}, kRows, 0.05);
  CHECK(exact.stiffness_scale == Approx(0.8).epsilon(1e-12));
  CHECK(exact.cost == Approx(0).margin(1e-12));
  const auto wide = best_scale({answer(kRows, 1.25, 1.02)}, kRows, 0.05);
  CHECK(wide.stiffness_scale == Approx(0.8).epsilon(1e-12));
  CHECK(wide.cost == Approx(0.02 / std::sqrt(3.0)).epsilon(1e-9));
}

TEST_CASE("calibration: golden section finds a minimum inside and at either end") {
  // Oracle: analytic.
  const double at = GENERATE(-1.0, 0.0, 0.3, 0.77, 1.0, 2.0);
  const auto parabola = [&](double x) { return (x - at) * (x - at); };
  CHECK(golden_section(parabola, 0, 1, 1e-4) == Approx(std::clamp(at, 0.0, 1.0)).margin(1.1e-4));
}

TEST_CASE("calibration: a stop request ends a comparison") {
  // Oracle: the contract.
  Case ball;
  ball.rows = kRows;
  CHECK_THROWS_AS(compare(ball, 1, [] { return true; }), report::Stopped);
}

TEST_CASE("calibration: tables and CSV hold every row, the worst error only from 30 %") {
  // Oracle: count of lines, and the errors put in.
  Case ball;
  ball.name = "ball";
  ball.rows = kRows;
  auto comparison = answer(kRows, 1.07, 1);
  comparison.equilibria[0].force *= 3;
  CHECK(worst_error(ball, comparison) == Approx(0.07));
  std::ostringstream csv, text;
  csv << kCsvHeader;
  write_csv(ball, {comparison, comparison}, csv);
  const std::string written = csv.str();
  CHECK(std::count(written.begin(), written.end(), '\n') == 5);
  CHECK_THAT(written, Contains("ball,1,0.5,1,6.42,6,1059.3,990,0.0615,0.0615\n"));
  print_settings(ball, text);
  print_fit_header(ball, text);
  print_fit(ball, {0.1, 0.05, 1, 0.02}, text);
  print_comparisons(ball, {comparison}, text);
  CHECK_THAT(text.str(), Contains("largest error at 30 to 50 %: 7.0 %"));
}

}  // namespace
}  // namespace palpate::calibration
