#include "modules/runtime/program.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <new>
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

TEST_CASE("program: a count that is negative or too large is refused, not wrapped") {
  // Oracle: the exit codes of core/error.h; 2^64 - 1 is the largest there is.
  const auto code_of = [](std::string seed) {
    runtime::Program program("Tests.", "palpate-test");
    std::size_t value = 0;
    program.add("--seed", value, "Of it");
    std::string name = "palpate-test", option = "--seed";
    char* argv[] = {name.data(), option.data(), seed.data()};
    return program.run(3, argv, [] { return 0; });
  };
  for (const char* seed : {"-1", "18446744073709551616", "99999999999999999999999"}) {
    CHECK(code_of(seed) == kExitBadInput);
  }
  for (const char* seed : {"0", "7", "18446744073709551615"}) CHECK(code_of(seed) == kExitDone);
}

TEST_CASE("program: numbers are decimal, as in a scene file") {
  // Oracle: by hand; 0x10 was taken for 16, and 0150 for 104.
  const auto code_of = [](std::string option, std::string number) {
    runtime::Program program("Tests.", "palpate-test");
    std::size_t count = 0;
    double length = 0;
    program.add("--count", count, "How many");
    program.add("--length", length, "How long");
    std::string name = "palpate-test";
    char* argv[] = {name.data(), option.data(), number.data()};
    return program.run(3, argv, [] { return 0; });
  };
  for (const char* other : {"0x10", "0X1"}) {
    CHECK(code_of("--count", other) == kExitBadInput);
    CHECK(code_of("--length", other) == kExitBadInput);
  }
  for (const char* octal : {"0150", "00"}) CHECK(code_of("--count", octal) == kExitBadInput);
  for (const char* good : {"0", "10", "100"}) CHECK(code_of("--count", good) == kExitDone);
  for (const char* good : {"0", "0.5", "0e0", "-0.1", "00.5"}) {
    CHECK(code_of("--length", good) == kExitDone);
  }
}

TEST_CASE("program: memory that is not there is said in words") {
  // Oracle: the exit codes of core/error.h; what is reported.
  runtime::Program program("Tests.", "palpate-test");
  std::string said;
  program.report_to([&](const std::string& what) { said = what; });
  std::string name = "palpate-test";
  char* argv[] = {name.data()};
  CHECK(program.run(1, argv, []() -> int { throw std::bad_alloc(); }) == kExitFailed);
  CHECK(said == "not enough memory");
}

TEST_CASE("program: the version names the project and the protocol") {
  // Oracle: the protocol number in messages.h.
  const std::string text = runtime::version_text();
  CHECK(text.rfind("palpate ", 0) == 0);
  CHECK(text.ends_with(", protocol " + std::to_string(kProtocolVersion)));
}

TEST_CASE("program: a variable of the environment is blamed for what it says, not its option") {
  // Oracle: the text. It was "--domain: Value abc not in range 0 to 200".
  const auto said_of = [](std::vector<std::string> words) {
    runtime::Program program("Tests.", "palpate-test");
    std::string said;
    program.report_to([&](const std::string& what) { said = what; });
    int domain = 0;
    program.add("--domain", domain, "Of it").environment("PALPATE_TEST_DOMAIN").range(0, 200);
    words.insert(words.begin(), "palpate-test");
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    const int code = program.run(int(argv.size()), argv.data(), [] { return 0; });
    return std::to_string(code) + " " + said;
  };
  setenv("PALPATE_TEST_DOMAIN", "abc", 1);
  CHECK(said_of({}).find("2 PALPATE_TEST_DOMAIN of the environment, for --domain: Value abc") == 0);
  CHECK(said_of({"--domain", "xyz"}) == "2 ");  // the parser's own words
  CHECK(said_of({"--domain", "abc"}) == "2 ");
  CHECK(said_of({"--domain=xyz"}) == "2 ");
  CHECK(said_of({"--domain", "3"}) == "0 ");
  unsetenv("PALPATE_TEST_DOMAIN");
  CHECK(said_of({}) == "0 ");
}
