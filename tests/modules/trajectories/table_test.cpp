#include "modules/trajectories/table.h"

#include <catch2/catch.hpp>

#include "tests/scratch_folder.h"

using namespace palpate;
using namespace palpate::trajectories;

TEST_CASE("table: a stamp's digits are kept whatever its sign and form") {
  // Oracle: differences written in the text; 1e6 s from zero and more are counted from the first.
  const ScratchFolder folder;
  const auto steps = [&](const std::string& first, const std::string& second) {
    std::vector<std::string> warnings;
    const auto poses = read_table(
        {.file = folder.write("stamps.csv", "t,x,y,z,qx,qy,qz,qw\n" + first + ",0,0,0,0,0,0,1\n" +
                                                second + ",0,0,0,0,0,0,1\n")},
        warnings, {});
    return poses.at(1).time - poses.at(0).time;
  };
  CHECK(steps("1700000000.000000001", "1700000000.000002001") == Approx(2e-6).epsilon(1e-9));
  CHECK(steps("-1700000000.000002001", "-1700000000.000000001") == Approx(2e-6).epsilon(1e-9));
  CHECK(steps("1700000000", "1700000000.5") == 0.5);
  CHECK(steps("1.7e9", "1700000001.") == 1);
  CHECK(steps("0.25", "5e-1") == 0.25);
}
