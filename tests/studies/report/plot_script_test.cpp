#include "studies/report/plot_script.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
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

TEST_CASE("plot script: whoever wants the drawing to end ends it") {
  // Oracle: a clock; the program would take a minute.
  struct Stop {};
  const auto begin = std::chrono::steady_clock::now();
  CHECK_THROWS_AS(run_program({"sleep", "60"}, [] { throw Stop{}; }), Stop);
  CHECK_THROWS_AS(draw_figures(kScript, "/nowhere", {}, [] { throw Stop{}; }), Stop);
  CHECK(std::chrono::steady_clock::now() < begin + std::chrono::seconds(10));
  CHECK(run_program({"sh", "-c", "exit 7"}, [] {}) == 7);
}

TEST_CASE("plot script: what nobody knows of a program is no success") {
  // Oracle: waitpid(2): children of who ignores SIGCHLD leave no status.
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  CHECK(run_program({"sh", "-c", "exit 7"}) == -1);
  std::signal(SIGCHLD, before);
  CHECK(run_program({"sh", "-c", "exit 7"}) == 7);
  CHECK(run_program({"/nowhere"}) == -1);
}

}  // namespace
}  // namespace palpate::report
