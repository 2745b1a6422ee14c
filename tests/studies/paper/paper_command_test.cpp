// The program as it is typed.
#include "studies/paper/paper_command.h"

#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <sstream>

#include "modules/core/error.h"
#include "palpate/child_process.h"
#include "studies/report/progress.h"
#include "tests/modules/runtime/own_bus.h"
#include "tests/scratch_folder.h"

namespace palpate::paper {
namespace {

const std::filesystem::path kProgram = std::filesystem::path(PALPATE_BIN_DIR) / "palpate-paper";

TEST_CASE("paper command: a figure alone leaves its picture, its tables and the summary") {
  // Oracle: the folder. Pictures need matplotlib, which the tests' machine is to have.
  const ScratchFolder folder;
  std::ostringstream out, log;
  const PaperOptions options{folder.path(), {"1"}, false, 240};
  CHECK(run_paper(options, out, log) == kExitDone);
  INFO(log.str());
  CHECK(std::filesystem::file_size(folder / "figure1.png") > 50'000);
  CHECK_FALSE(std::filesystem::exists(folder / "figure2.png"));
  CHECK_THAT(text_in(folder / "summary.csv"), Catch::Contains("550"));
  CHECK_THAT(out.str(), Catch::Contains("paper: 550 nodes, 1,084 triangles"));
}

TEST_CASE("paper command: a folder that cannot be written is bad input") {
  // Oracle: the error family.
  std::ostringstream out, log;
  CHECK_THROWS_AS(run_paper({"/proc/nowhere", {"1"}, false, 240}, out, log), InputError);
}

TEST_CASE("paper command: Ctrl-C ends it at once, with 130 and nothing half written") {
  // Oracle: the exit code of shells for SIGINT, and the folder.
  const ScratchFolder folder;
  launcher::ChildProcess child(kProgram, {"--only", "4", "--out", folder.path().string()});
  std::string said;
  palpate::testing::wait_until([&] {
    for (const auto& line : child.take_lines()) said += line + "\n";
    return said.find("simulated") != std::string::npos;
  });
  child.signal(SIGINT);
  palpate::testing::wait_until([&] { return child.ended().has_value(); });
  REQUIRE(child.ended());
  CHECK((WIFEXITED(*child.ended()) && WEXITSTATUS(*child.ended()) == kExitStopped));
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    CHECK(entry.path().extension() != ".part");
  }
}

}  // namespace
}  // namespace palpate::paper
