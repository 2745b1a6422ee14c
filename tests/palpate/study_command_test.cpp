// `palpate WORD` becomes the program of a measurement.
#include "palpate/study_command.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "modules/core/error.h"
#include "tests/palpate/typed_command.h"

using namespace palpate;
using Catch::Contains;
using palpate::testing::type;

TEST_CASE("study command: a program that is missing is named") {
  // Oracle: the message text.
  CHECK_THROWS_WITH(launcher::become("/nowhere/palpate-paper", {}),
                    "/nowhere/palpate-paper is missing; build it: cmake --build --preset release "
                    "--target palpate-paper");
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
  const auto own_help = type("palpate", {"--help"});
  CHECK(own_help.code == kExitDone);
  for (const auto& study : launcher::studies()) {
    INFO(study.word);
    CHECK_THAT(own_help.said, Contains(study.word) && Contains(study.meaning));
    const auto help = type("palpate", {study.word, "--help"});
    CHECK(help.code == kExitDone);
    CHECK_THAT(help.said, Contains(std::string("palpate ") + study.word));
  }
  CHECK(type("palpate", {"paper", "--only", "5"}).code == kExitBadInput);
  CHECK(type("palpate", {"chart", "--case", "cone"}).code == kExitBadInput);
  CHECK(type("palpate", {"plan"}).code == kExitBadInput);
  CHECK(type("palpate", {"stability", "--only", "weather"}).code == kExitBadInput);
}

TEST_CASE("study command: what is wrong is named by the option that says it") {
  // Oracle: the words. A folder for points was called --out, and --scene left the others out.
  const auto points = type("palpate", {"plan", "stomach_probe", "--points", "/dev/null"});
  CHECK(points.code == kExitBadInput);
  CHECK_THAT(points.said, Contains("--points '/dev/null': must be a folder"));
  for (const std::vector<std::string>& other :
       {std::vector<std::string>{"--scenes", "2"}, {"--again"}}) {
    std::vector<std::string> words{"fuzz", "--scene", "1"};
    words.insert(words.end(), other.begin(), other.end());
    const auto outcome = type("palpate", words);
    CHECK(outcome.code == kExitBadInput);
    CHECK_THAT(outcome.said, Contains("excludes"));
  }
  const auto empty = type("palpate", {"stability", "--series", ""});
  CHECK(empty.code == kExitBadInput);
  CHECK_THAT(empty.said, Contains("--series: an empty list names nothing"));
}
