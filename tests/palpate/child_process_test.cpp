#include "palpate/child_process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>

#include "modules/runtime/kept_state.h"
#include "tests/modules/runtime/own_bus.h"
#include "tests/palpate/shell_script.h"

using palpate::launcher::ChildProcess;
using palpate::launcher::describe_exit;
using palpate::testing::Scripts;
using palpate::testing::wait_until;

namespace {

/// All lines until it has ended.
std::vector<std::string> lines_to_the_end(ChildProcess& child) {
  std::vector<std::string> lines;
  const auto listen = [&] {
    for (auto& line : child.take_lines()) lines.push_back(line);
  };
  wait_until([&] {
    listen();
    return child.ended().has_value();
  });
  listen();
  return lines;
}

}  // namespace

TEST_CASE("child process: its lines come whole, from stdout and stderr, and its last words too") {
  // Oracle: what the script prints.
  const Scripts scripts;
  const auto script =
      scripts.add("speaker", "echo one; printf tw >&2; sleep 0.1; echo o >&2; printf unfinished");
  ChildProcess child(script, {});
  CHECK(lines_to_the_end(child) == std::vector<std::string>{"one", "two", "unfinished"});
}

TEST_CASE("child process: gets its arguments as they are") {
  // Oracle: what the script prints.
  const Scripts scripts;
  ChildProcess child(scripts.add("echoer", "for a in \"$@\"; do echo \"<$a>\"; done"),
                     {"a b", "$HOME", ""});
  CHECK(lines_to_the_end(child) == std::vector<std::string>{"<a b>", "<$HOME>", "<>"});
}

TEST_CASE("child process: what it is given for its environment replaces what has the same name") {
  // Oracle: what the shell finds; of two names one begins with the other.
  ::setenv("PALPATE_TEST_A", "ours", 1);
  ::setenv("PALPATE_TEST_AB", "kept", 1);
  const Scripts scripts;
  ChildProcess child(scripts.add("teller",
                                 "echo $PALPATE_TEST_A $PALPATE_TEST_AB; env | grep -c "
                                 "^PALPATE_TEST_A="),
                     {}, {}, {"PALPATE_TEST_A=given"});
  ::unsetenv("PALPATE_TEST_A");
  ::unsetenv("PALPATE_TEST_AB");
  CHECK(lines_to_the_end(child) == std::vector<std::string>{"given kept", "1"});
}

TEST_CASE("child process: gets the one descriptor that it is to inherit") {
  // Oracle: the kernel's list; of two files that close on exec the child has one.
  const palpate::runtime::KeptMemory given, other;
  const Scripts scripts;
  const auto script =
      scripts.add("looker", "for n in \"$@\"; do test -e /proc/$$/fd/$n; echo $?; done");
  const std::vector<std::string> names{std::to_string(given.descriptor()),
                                       std::to_string(other.descriptor())};
  ChildProcess child(script, names, given.descriptor());
  CHECK(lines_to_the_end(child) == std::vector<std::string>{"0", "1"});
}

TEST_CASE("child process: how it ended is said in words") {
  // Oracle: the ends of two scripts.
  const Scripts scripts;
  ChildProcess failing(scripts.add("failing", "exit 3"), {});
  REQUIRE(wait_until([&] { return failing.ended().has_value(); }));
  CHECK(describe_exit(*failing.ended()) == "exit code 3");
  ChildProcess killed(scripts.add("killed", "kill -9 $$"), {});
  REQUIRE(wait_until([&] { return killed.ended().has_value(); }));
  CHECK(describe_exit(*killed.ended()) == "killed by signal 9 (Killed)");
}

TEST_CASE("child process: a program that cannot start is named") {
  // Oracle: the message.
  CHECK_THROWS_WITH(
      ChildProcess("/nowhere/palpate-none", {}),
      Catch::Contains("cannot start /nowhere/palpate-none: No such file or directory; it may "
                      "not be built: ") &&
          Catch::Contains("--target palpate-none"));
}

TEST_CASE("child process: is in a process group of its own and ends with its owner") {
  // Oracle: the kernel.
  const Scripts scripts;
  pid_t child_id = 0;
  {
    ChildProcess child(scripts.add("sleeper", "echo up; exec sleep 100"), {});
    child_id = child.process_id();
    REQUIRE(wait_until([&] { return !child.take_lines().empty(); }));
    CHECK(getpgid(child_id) == child_id);
    CHECK_FALSE(child.ended());
  }
  CHECK(kill(child_id, 0) == -1);
}

TEST_CASE("child process: a launcher that is killed takes it along") {
  // Oracle: the kernel. A process between us and the child is killed hard.
  const Scripts scripts;
  const auto script = scripts.add("sleeper", "exec sleep 100");
  int channel[2];
  REQUIRE(pipe(channel) == 0);
  const pid_t launcher = fork();
  if (launcher == 0) {
    ChildProcess child(script, {});
    const pid_t id = child.process_id();
    if (write(channel[1], &id, sizeof id) != sizeof id) _exit(1);
    pause();
    _exit(0);
  }
  pid_t grandchild = 0;
  REQUIRE(read(channel[0], &grandchild, sizeof grandchild) == sizeof grandchild);
  kill(launcher, SIGKILL);
  waitpid(launcher, nullptr, 0);
  CHECK(wait_until([&] {
    // gone, or a zombie that waits for init
    const auto state = "/proc/" + std::to_string(grandchild) + "/status";
    std::ifstream stream(state);
    for (std::string line; std::getline(stream, line);) {
      if (line.rfind("State:", 0) == 0) return line.find('Z') != std::string::npos;
    }
    return true;
  }));
  close(channel[0]);
  close(channel[1]);
}
