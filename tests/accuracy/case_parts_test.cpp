#include "bench/accuracy/case_parts.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "modules/core/error.h"
#include "tests/accuracy/folders.h"

namespace palpate::accuracy {
namespace {

TEST_CASE("case parts: a reference table is read by column and looked up by value") {
  // Oracle: the table, read by eye.
  const testing::WorkFolder folder;
  std::ofstream(folder.path / "table.csv") << "a,b,kind\n0.5,2,x\n0.75,3e-1,y\n";
  const ReferenceTable table(folder.path / "table.csv");
  CHECK(table.size() == 2);
  CHECK(table.at("b", table.row_of("a", 0.75)) == 0.3);
  CHECK_THROWS_WITH(table.at("c", 0), Catch::Contains("table.csv:1: column 'c' is missing"));
  CHECK_THROWS_WITH(table.row_of("a", 1), Catch::Contains("no row with a = 1"));
  CHECK_THROWS_AS(ReferenceTable(folder.path / "none.csv"), InputError);
}

TEST_CASE("case parts: plates face each other") {
  // Oracle: a plane is solid below its own z = 0.
  CHECK(plate(0.1, true).to_world(Vec3::UnitZ()).z() > 0.1);
  CHECK(plate(0.1, false).to_world(Vec3::UnitZ()).z() < 0.1);
}

}  // namespace
}  // namespace palpate::accuracy
