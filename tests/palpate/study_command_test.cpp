// `palpate WORD` becomes the program of a measurement.
#include "palpate/study_command.h"

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

TEST_CASE("study command: a program that is missing is named") {
  // Oracle: the message text.
  CHECK_THROWS_WITH(launcher::become("/nowhere/palpate-paper", {}),
                    "/nowhere/palpate-paper is missing; build it");
}

TEST_CASE("study command: a program that cannot be started is named") {
  // Oracle: the message text, for a file that is no program.
  const auto folder = std::filesystem::temp_directory_path() / "palpate_study_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "palpate-paper") << "not a program";
  CHECK_THROWS_WITH(launcher::become(folder / "palpate-paper", {}),
                    Contains("cannot start") && Contains("palpate-paper"));
  std::filesystem::remove_all(folder);
}

TEST_CASE("study command: typed, it passes options on and the exit code back") {
  // Oracle: the programs' own help and the exit codes of core/error.h.
  const auto own_help = type({"--help"});
  CHECK(own_help.code == kExitDone);
  for (const auto& study : launcher::studies()) {
    INFO(study.word);
    CHECK_THAT(own_help.said, Contains(study.word) && Contains(study.meaning));
    const auto help = type({study.word, "--help"});
    CHECK(help.code == kExitDone);
    CHECK_THAT(help.said, Contains(std::string("palpate ") + study.word));
  }
  CHECK(type({"paper", "--only", "5"}).code == kExitBadInput);
  CHECK(type({"chart", "--case", "cone"}).code == kExitBadInput);
  CHECK(type({"plan"}).code == kExitBadInput);
  CHECK(type({"stability", "--only", "weather"}).code == kExitBadInput);
}
