#include "modules/trajectories/pose_collector.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"

using namespace palpate;
using namespace palpate::trajectories;

TEST_CASE("pose collector: places are named as its file names them") {
  // Oracle: the stated form, over poses left out.
  std::vector<std::string> warnings;
  PoseCollector poses("a.bag", ": message ", warnings);
  for (std::size_t i = 1; i <= 9; ++i) {
    if (i == 4) poses.leave_out(i, "its reason");
    if (i != 4) poses.add(i, 0.01 * double(i < 8 ? i : i + 30), {});
  }
  CHECK(std::move(poses).finish(9).size() == 8);
  REQUIRE(warnings.size() == 2);
  CHECK(warnings[0] == "a.bag: message 4: left out: its reason");
  CHECK_THAT(warnings[1], Catch::StartsWith("a.bag: message 8: gap of 0.31 s"));
}

TEST_CASE("pose collector: a time that goes back by more than disorder is refused at once") {
  // Oracle: the stated rule.
  std::vector<std::string> warnings;
  PoseCollector poses("a.csv", ":", warnings);
  poses.add(2, 5, {});
  poses.add(3, 4.5, {});  // left out
  CHECK(poses.size() == 1);
  CHECK_THROWS_AS(poses.add(4, 3.9, {}), InputError);
}
