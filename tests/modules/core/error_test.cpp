#include "modules/core/error.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <string>

using namespace palpate;

namespace {

struct Ended {
  int status = 0;
  std::string error_output;
};

/// What becomes of a child process in which an assumption fails.
Ended demand_in_child(int value) {
  std::array<int, 2> ends{};
  REQUIRE(pipe(ends.data()) == 0);
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    dup2(ends[1], STDERR_FILENO);
    std::signal(SIGABRT, SIG_DFL);
    PALPATE_DEMAND(value == 42);
    _exit(7);
  }
  close(ends[1]);
  Ended ended;
  std::array<char, 512> block{};
  for (ssize_t count; (count = read(ends[0], block.data(), block.size())) > 0;) {
    ended.error_output.append(block.data(), static_cast<std::size_t>(count));
  }
  close(ends[0]);
  REQUIRE(waitpid(child, &ended.status, 0) == child);
  return ended;
}

}  // namespace

TEST_CASE("error: an InputError is a runtime_error and keeps its line") {
  // Oracle: the text given.
  const InputError error("scene.yaml:12: key 'x' is missing");
  CHECK(std::string(static_cast<const std::runtime_error&>(error).what()) ==
        "scene.yaml:12: key 'x' is missing");
}

TEST_CASE("error: exit codes are those the manual promises") {
  // Oracle: the command line's contract: 0 done, 1 failed while running, 2 bad input.
  CHECK(kExitDone == 0);
  CHECK(kExitFailed == 1);
  CHECK(kExitBadInput == 2);
}

TEST_CASE("error: a demand that holds lets the program go on") {
  // Oracle: the child's own exit code.
  const Ended ended = demand_in_child(42);
  REQUIRE(WIFEXITED(ended.status));
  CHECK(WEXITSTATUS(ended.status) == 7);
  CHECK(ended.error_output.empty());
}

TEST_CASE("error: a demand that fails aborts and prints condition, file and line") {
  // Oracle: the signal and output of a real process.
  const Ended ended = demand_in_child(41);
  REQUIRE(WIFSIGNALED(ended.status));
  CHECK(WTERMSIG(ended.status) == SIGABRT);
  CHECK_THAT(ended.error_output, Catch::Contains("error_test.cpp:") &&
                                     Catch::Contains("broken assumption: value == 42"));
}
