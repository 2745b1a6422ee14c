#include "modules/runtime/program.h"

#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "modules/core/error.h"
#include "modules/messages/messages.h"

using namespace palpate;

namespace {

/// Exit code of a program with one option, --size, and this body.
int run_main(std::vector<std::string> words, const std::function<int()>& body) {
  words.insert(words.begin(), "palpate-test");
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  runtime::Program program("Tests.", "palpate-test");
  int size = 0;
  program.add("--size", size, "Of it");
  return program.run(static_cast<int>(argv.size()), argv.data(), body);
}

}  // namespace

TEST_CASE("program: the body's result is the exit code") {
  // Oracle: definition.
  CHECK(run_main({"--size", "3"}, [] { return 7; }) == 7);
}

TEST_CASE("program: --version and --help are answers, and the body does not run") {
  // Oracle: the exit codes of core/error.h.
  for (const char* word : {"--version", "--help"}) {
    bool ran = false;
    CHECK(run_main({word}, [&] { return ran = true, 1; }) == kExitDone);
    CHECK_FALSE(ran);
  }
}

TEST_CASE("program: a wrong command line and what is thrown decide the exit code") {
  // Oracle: the exit codes of core/error.h.
  CHECK(run_main({"--sizes", "3"}, [] { return 0; }) == kExitBadInput);
  CHECK(run_main({}, []() -> int { throw InputError("s.yaml:3: no"); }) == kExitBadInput);
  CHECK(run_main({}, []() -> int { throw std::runtime_error("disk full"); }) == kExitFailed);
  CHECK(run_main({}, []() -> int { throw Interrupted("gmsh: interrupted"); }) == kExitStopped);
}

TEST_CASE("program: the version names the project and the protocol") {
  // Oracle: the protocol number in messages.h.
  const std::string text = runtime::version_text();
  CHECK(text.rfind("palpate ", 0) == 0);
  CHECK(text.ends_with(", protocol " + std::to_string(kProtocolVersion)));
}
