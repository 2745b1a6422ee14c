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

}  // namespace
}  // namespace palpate::report
