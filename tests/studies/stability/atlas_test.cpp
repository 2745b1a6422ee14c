#include "studies/stability/atlas.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "tests/scratch_folder.h"
#include "tests/studies/chart/folders.h"
#include "tests/studies/damages.h"
#include "tests/studies/keep_on.h"

namespace palpate::stability {
namespace {

using report::kKeepOn;

/// Stands up to 0.7/x; above that oscillates, above three times that diverges.
Map made_up(int* tries = nullptr) {
  Map map{"made_up", {"one"}, {1, 2}, geometric(0.01, 10, 4), 0.01, {}, {}};
  map.attempt = [tries](const std::string&, double x, double y, const KeepGoing& keep_going) {
    keep_going();
    if (tries != nullptr) ++*tries;
    Verdict verdict;
    verdict.energy = y;
    const double limit = 0.7 / x;
    if (y > limit) verdict.state = y > 3 * limit ? State::kDiverged : State::kOscillating;
    return verdict;
  };
  map.predict = [](const std::string&, double x) { return Prediction{0.7 / x, 0.3, true}; };
  return map;
}

Cell cell(double y, State state) {
  Cell result;
  result.y = y;
  result.verdict.state = state;
  return result;
}

TEST_CASE("atlas: the frontier is bisected to the precision asked for, from below") {
  // Oracle: the limit of a made-up method.
  const Map map = made_up();
  for (const double x : map.xs) {
    const Column column = measure_column(map, "one", x, kKeepOn);
    const Frontier frontier = frontier_of(column.cells);
    CHECK(frontier.edge == Edge::kFound);
    CHECK(frontier.value <= 0.7 / x);
    CHECK(frontier.value * (1 + map.precision) >= 0.7 / x);
    CHECK(std::is_sorted(column.cells.begin(), column.cells.end(),
                         [](const Cell& a, const Cell& b) { return a.y < b.y; }));
  }
}

TEST_CASE("atlas: frontiers outside the map are said to be so, what stands again is not trusted") {
  // Oracle: the definition.
  const auto all = frontier_of({cell(1, State::kStable), cell(2, State::kDrifting)});
  CHECK(all.edge == Edge::kAllHold);
  CHECK(all.value == 2);
  CHECK(all.floor == 0);
  CHECK(frontier_of({cell(1, State::kDiverged), cell(2, State::kOscillating)}).edge ==
        Edge::kNoneHolds);
  const auto between = frontier_of({cell(1, State::kDiverged), cell(2, State::kOscillating),
                                    cell(3, State::kStable), cell(4, State::kDiverged)});
  CHECK(between.edge == Edge::kFound);
  CHECK(between.value == 3);
  CHECK(between.floor == 2);
  const auto first =
      frontier_of({cell(1, State::kStable), cell(2, State::kOscillating), cell(3, State::kStable)});
  CHECK(first.edge == Edge::kFound);
  CHECK(first.value == 1);
}

TEST_CASE("atlas: a stored column comes back the same, and only for its own grid") {
  // Oracle: round trip to the ten digits of the file; no try is made for what is stored.
  const chart::testing::WorkFolder folder;
  std::ostringstream log;
  const ColumnStore store(folder.path / "points", log);
  Map map = made_up();
  Column back;
  CHECK_FALSE(store.read(map, "one", 1, back));
  const Column column = measure_column(map, "one", 1, kKeepOn);
  store.write(map, column);
  REQUIRE(store.read(map, "one", 1, back));
  CHECK(back.map == column.map);
  CHECK(back.series == "one");
  CHECK(back.prediction.value == Approx(0.7));
  CHECK(back.prediction.given == Approx(0.3));
  CHECK(back.prediction.exact);
  REQUIRE(back.cells.size() == column.cells.size());
  for (std::size_t i = 0; i < back.cells.size(); ++i) {
    CHECK(back.cells[i].y == Approx(column.cells[i].y).epsilon(1e-9));
    CHECK(back.cells[i].verdict.state == column.cells[i].verdict.state);
    CHECK(back.cells[i].verdict.energy == Approx(column.cells[i].verdict.energy).epsilon(1e-9));
  }
  CHECK_FALSE(store.read(map, "one", 2, back));
  map.precision = 0.05;
  CHECK_FALSE(store.read(map, "one", 1, back));
  map.precision = 0.01;
  map.ys.pop_back();
  CHECK_FALSE(store.read(map, "one", 1, back));
  CHECK(log.str().empty());
}

TEST_CASE("atlas: a column that is not whole is named, and is as if it was not there") {
  // Oracle: definition.
  const ScratchFolder folder;
  std::ostringstream ignored;
  const Map map = made_up();
  Column back;
  ColumnStore(folder.path(), ignored).write(map, measure_column(map, "one", 1, kKeepOn));
  const auto file = std::filesystem::directory_iterator(folder.path())->path().filename().string();
  for (const std::string& text : damaged(text_in(folder / file))) {
    INFO(text);
    folder.write(file, text);
    std::ostringstream log;
    CHECK_FALSE(ColumnStore(folder.path(), log).read(map, "one", 1, back));
    CHECK_THAT(log.str(), Catch::Contains(file + ": was "));
  }
}

TEST_CASE("atlas: values in equal ratios begin and end where asked") {
  // Oracle: analytic.
  const auto values = geometric(1e-3, 1, 4);
  REQUIRE(values.size() == 4);
  for (int i = 0; i < 4; ++i) {
    CHECK(values[static_cast<std::size_t>(i)] == Approx(std::pow(10, i - 3)));
  }
}

}  // namespace
}  // namespace palpate::stability
