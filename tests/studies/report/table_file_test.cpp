#include "studies/report/table_file.h"

#include <catch2/catch.hpp>

#include "tests/scratch_folder.h"

namespace palpate::report {
namespace {

TEST_CASE("table file: rows as written, cells with commas quoted") {
  // Oracle: the text by hand, RFC 4180.
  const ScratchFolder folder;
  TableFile table(folder / "a.csv", {"x_m", "word"});
  table.write_row({0.1, -2e-12});
  table.write_row(std::vector<std::string>{"a, b", "say \"c\""});
  table.finish();
  CHECK(text_in(folder / "a.csv") == "x_m,word\n0.1,-2e-12\n\"a, b\",\"say \"\"c\"\"\"\n");
}

TEST_CASE("table file: without finish nothing is left, and what was there stays") {
  // Oracle: the folder.
  const ScratchFolder folder;
  const auto file = folder / "a.csv";
  std::ofstream(file) << "old";
  {
    TableFile table(file, {"x"});
    table.write_row({1.0});
    CHECK(text_in(file) == "old");
  }
  CHECK(text_in(file) == "old");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("table file: where nothing can be written it says so") {
  // Oracle: the message.
  CHECK_THROWS_WITH(TableFile("/nowhere/a.csv", {"x"}),
                    Catch::StartsWith("cannot write /nowhere/a.csv.") && Catch::EndsWith(".part"));
}

}  // namespace
}  // namespace palpate::report
