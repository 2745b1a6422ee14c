#include "modules/runtime/module_options.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <vector>

#include "modules/core/error.h"

using namespace palpate;
using runtime::ModuleOptions;

namespace {

struct Outcome {
  int code = -1;
  bool ran = false;
  ModuleOptions options;
};

Outcome run(
    std::vector<std::string> arguments, const std::function<void()>& job = [] {}) {
  arguments.insert(arguments.begin(), "palpate-haptics");
  std::vector<char*> argv;
  for (auto& argument : arguments) argv.push_back(argument.data());
  Outcome outcome;
  outcome.code =
      runtime::run_module(static_cast<int>(argv.size()), argv.data(),
                          {"haptics", "Renders forces.", {}}, [&](const ModuleOptions& options) {
                            outcome.ran = true;
                            outcome.options = options;
                            job();
                          });
  return outcome;
}

}  // namespace

TEST_CASE("module options: scene, session, domain and priority arrive") {
  // Oracle: definition.
  const auto outcome = run({"s.yaml", "--session", "a", "--domain", "7", "--no-realtime"});
  CHECK(outcome.code == kExitDone);
  CHECK(outcome.options.scene == "s.yaml");
  CHECK(outcome.options.bus.session == "a");
  CHECK(outcome.options.bus.domain == 7);
  CHECK_FALSE(outcome.options.realtime);
}

TEST_CASE("module options: PALPATE_DOMAIN is the default domain, --domain overrides it") {
  // Oracle: definition.
  setenv("PALPATE_DOMAIN", "42", 1);
  CHECK(run({"s.yaml"}).options.bus.domain == 42);
  CHECK(run({"s.yaml", "--domain", "3"}).options.bus.domain == 3);
  unsetenv("PALPATE_DOMAIN");
  CHECK(run({"s.yaml"}).options.bus.domain == 0);
  CHECK(run({"s.yaml"}).options.realtime);
}

TEST_CASE("module options: a wrong command line is bad input and runs nothing") {
  // Oracle: the exit codes of core/error.h.
  const std::vector<std::vector<std::string>> wrong{{},
                                                    {"s.yaml", "--domain", "201"},
                                                    {"s.yaml", "--domain", "x"},
                                                    {"s.yaml", "--sesion", "a"},
                                                    {"s.yaml", "t.yaml"}};
  for (const auto& arguments : wrong) {
    const auto outcome = run(arguments);
    CHECK(outcome.code == kExitBadInput);
    CHECK_FALSE(outcome.ran);
  }
}

TEST_CASE("module options: --help is an answer, not an error") {
  // Oracle: the exit codes of core/error.h.
  const auto outcome = run({"--help"});
  CHECK(outcome.code == kExitDone);
  CHECK_FALSE(outcome.ran);
}

TEST_CASE("module options: what is thrown decides the exit code") {
  // Oracle: the exit codes of core/error.h.
  CHECK(run({"s.yaml"}, [] { throw InputError("s.yaml:3: no"); }).code == kExitBadInput);
  CHECK(run({"s.yaml"}, [] { throw std::runtime_error("disk full"); }).code == kExitFailed);
}

TEST_CASE("module options: what is of a lockstep alone is refused without one") {
  // Oracle: the exit codes of core/error.h. It was ignored.
  const std::vector<std::vector<std::string>> alone{{"--from-snapshot", "x"},
                                                    {"--snapshot-at", "3", "--snapshot", "x"}};
  for (const auto& options : alone) {
    auto words = options;
    words.insert(words.begin(), "s.yaml");
    CHECK(run(words).code == kExitBadInput);
    CHECK_FALSE(run(words).ran);
    words.insert(words.end(), {"--lockstep", "haptics"});
    CHECK(run(words).code == kExitDone);
  }
  CHECK(run({"s.yaml", "--lockstep", "haptics", "--snapshot-at", "3"}).code == kExitBadInput);
  CHECK(run({"s.yaml", "--lockstep", "haptics", "--snapshot", "x"}).code == kExitBadInput);
}
