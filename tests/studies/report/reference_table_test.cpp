#include "studies/report/reference_table.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "modules/core/error.h"
#include "tests/scratch_folder.h"

namespace palpate::report {
namespace {

TEST_CASE("reference table: is read by column and looked up by value") {
  // Oracle: the table, read by eye.
  const ScratchFolder folder;
  const auto file = folder / "table.csv";
  std::ofstream(file) << "a,b,kind\n0.5,2,x\n0.75,3e-1,y\n";
  const ReferenceTable table(file);
  CHECK(table.size() == 2);
  CHECK(table.at("b", table.row_of("a", 0.75)) == 0.3);
  CHECK_THROWS_WITH(table.at("c", 0), Catch::Contains("table.csv:1: column 'c' is missing"));
  CHECK_THROWS_WITH(table.at("kind", 1), Catch::Contains("table.csv:3: column kind: not a number"));
  CHECK_THROWS_WITH(table.row_of("a", 1), Catch::Contains("no row with a = 1"));
  CHECK_THROWS_AS(ReferenceTable(folder / "none.csv"), InputError);
}

}  // namespace
}  // namespace palpate::report
