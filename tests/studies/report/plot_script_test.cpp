#include "studies/report/plot_script.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "modules/core/data_folder.h"
#include "tests/scratch_folder.h"

namespace palpate::report {
namespace {

using Catch::Contains;

const std::filesystem::path kScript = data_file("plots/plot_paper.py");

TEST_CASE("plot script: a script that fails is named, and the CSV files stay") {
  // Oracle: the message; a folder that does not exist is refused by the script.
  CHECK_THROWS_WITH(draw_figures(kScript, "/nowhere"),
                    Contains("no pictures") && Contains("/nowhere"));
}

TEST_CASE("plot script: without figures to draw it draws none and is content") {
  // Oracle: the folder.
  const ScratchFolder folder;
  CHECK_NOTHROW(draw_figures(kScript, folder.path()));
  CHECK(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace palpate::report
