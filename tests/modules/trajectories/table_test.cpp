#include "modules/trajectories/table.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
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

TEST_CASE("table: a database and line ends of old Macs are called what they are") {
  // Oracle: messages by hand; the header of SQLite's file format.
  const ScratchFolder folder;
  const auto said = [&](const std::string& name, const std::string& text) -> std::string {
    std::vector<std::string> warnings;
    try {
      read_table({.file = folder.write(name, text)}, warnings, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  CHECK_THAT(said("bag.db3", std::string("SQLite format 3\0\x10\0\1", 19)),
             Catch::Contains("bag.db3: is a bag of ROS 2 in SQLite") &&
                 Catch::Contains("ros2 bag convert -i"));
  std::string rows = "t,x,y,z,qx,qy,qz,qw\r";
  for (int i = 0; i < 100; ++i) rows += std::to_string(i) + ",0,0,0,0,0,0,1\r";
  const std::string alone = ": its lines end with a carriage return alone";
  CHECK_THAT(said("mac.csv", rows), Catch::Contains("mac.csv:1" + alone));
  for (int i = 100; i < 10'000; ++i) rows += std::to_string(i) + ",0,0,0,0,0,0,1\r";
  CHECK_THAT(said("long.csv", rows), Catch::Contains("long.csv:1" + alone));
  CHECK(said("dos.csv", "t,x,y,z,qx,qy,qz,qw\r\n0,0,0,0,0,0,0,1\r\r\n1,0,0,0,0,0,0,1\r\n") ==
        "accepted");
}
