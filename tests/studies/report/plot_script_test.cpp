#include "studies/report/plot_script.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "tests/studies/paper/temporary_folder.h"

namespace palpate::bench {
namespace {

using Catch::Contains;

const std::filesystem::path kScript =
    std::filesystem::path(PALPATE_SOURCE_DIR) / "scripts/plot_paper.py";

TEST_CASE("plot script: a script that fails is named, and the CSV files stay") {
  // Oracle: the message; a folder that does not exist is refused by the script.
  CHECK_THROWS_WITH(draw_figures(kScript, "/nowhere"),
                    Contains("no pictures") && Contains("/nowhere"));
}

TEST_CASE("plot script: without figures to draw it draws none and is content") {
  // Oracle: the folder.
  const testing::TemporaryFolder folder("plot");
  CHECK_NOTHROW(draw_figures(kScript, folder.path()));
  CHECK(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace palpate::bench
