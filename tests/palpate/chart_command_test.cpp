// `palpate chart` finds the program of a measurement and becomes it.
#include "palpate/chart_command.h"

#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <fstream>

#include "modules/core/error.h"
#include "palpate/child_process.h"
#include "tests/modules/runtime/waiting.h"

using namespace palpate;
using Catch::Contains;

namespace {

const std::filesystem::path kPrograms = PALPATE_BIN_DIR;

struct Outcome {
  int code = -1;
  std::string said;
};

Outcome type(const std::vector<std::string>& arguments) {
  launcher::ChildProcess child(kPrograms / "palpate", arguments);
  Outcome outcome;
  const auto listen = [&] {
    for (const auto& line : child.take_lines()) outcome.said += line + "\n";
  };
  testing::wait_until([&] {
    listen();
    return child.ended().has_value();
  });
  listen();
  if (child.ended() && WIFEXITED(*child.ended())) outcome.code = WEXITSTATUS(*child.ended());
  return outcome;
}

}  // namespace

TEST_CASE(
    "chart command: the program is named after the chart, the first one where none is named") {
  // Oracle: the naming rule of the benchmark programs; options stay for the program.
  std::vector<std::string> words{"paper", "--quick"};
  CHECK(launcher::chart_program(words) == "palpate-paper");
  CHECK(words == std::vector<std::string>{"--quick"});
  CHECK(launcher::chart_program(words) == "palpate-chart");
  CHECK(words == std::vector<std::string>{"--quick"});
}

TEST_CASE("chart command: what cannot be charted is refused with what can") {
  // Oracle: the message text.
  std::vector<std::string> words{"weather"};
  CHECK_THROWS_WITH(launcher::chart_program(words),
                    "chart 'weather': must be one of accuracy, paper, neighbours");
  CHECK_THROWS_WITH(launcher::become("/nowhere/palpate-paper", {}),
                    "/nowhere/palpate-paper is missing; build it");
}

TEST_CASE("chart command: a program that cannot be started is named") {
  // Oracle: the message text, for a file that is no program.
  const auto folder = std::filesystem::temp_directory_path() / "palpate_chart_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "palpate-paper") << "not a program";
  CHECK_THROWS_WITH(launcher::become(folder / "palpate-paper", {}),
                    Contains("cannot start") && Contains("palpate-paper"));
  std::filesystem::remove_all(folder);
}

TEST_CASE("chart command: typed, it passes options on and the exit code back") {
  // Oracle: the programs' own help and the exit codes of core/error.h.
  const auto help = type({"chart", "paper", "--help"});
  CHECK(help.code == kExitDone);
  CHECK_THAT(help.said, Contains("palpate chart paper") && Contains("--quick"));
  const auto own_help = type({"chart", "--help"});
  CHECK(own_help.code == kExitDone);
  for (const auto& name : launcher::chart_names()) CHECK_THAT(own_help.said, Contains(name));
  CHECK(type({"chart", "paper", "--only", "5"}).code == kExitBadInput);
  const auto unknown = type({"chart", "weather"});
  CHECK(unknown.code == kExitBadInput);
  CHECK_THAT(unknown.said, Contains("must be one of accuracy, paper, neighbours"));
  CHECK(type({"chart", "--case", "cone"}).code == kExitBadInput);
  CHECK(type({"plan"}).code == kExitBadInput);
  CHECK_THAT(type({"plan", "--help"}).said, Contains("palpate plan") && Contains("--seconds"));
  CHECK(type({"stability", "--only", "weather"}).code == kExitBadInput);
  CHECK_THAT(type({"stability", "--help"}).said, Contains("palpate stability"));
}
