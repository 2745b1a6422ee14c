#include "palpate/reaper.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <optional>
#include <string>

#include "tests/modules/runtime/own_bus.h"
#include "tests/scratch_folder.h"

using palpate::launcher::Reaper;
using palpate::testing::wait_until;

namespace {

/// Of a process that is killed, holding a reaper that watches a child of its own that is stopped.
/// @returns that child
pid_t orphan_of_killed_parent(const std::filesystem::path& folder = {}) {
  int told[2];
  REQUIRE(::pipe(told) == 0);
  const pid_t parent = fork();
  if (parent == 0) {
    Reaper reaper(folder);
    const pid_t child = fork();
    if (child == 0) {  // a program, as all children are: it holds no end of the reaper's pipe
      execl("/bin/sh", "sh", "-c", "kill -STOP $$", nullptr);
      _exit(0);
    }
    reaper.watch(child);
    if (::write(told[1], &child, sizeof child) != sizeof child) _exit(1);
    raise(SIGKILL);
  }
  pid_t child = -1;
  REQUIRE(::read(told[0], &child, sizeof child) == sizeof child);
  waitpid(parent, nullptr, 0);
  close(told[0]);
  close(told[1]);
  return child;
}

}  // namespace

TEST_CASE("reaper: a stopped child does not outlive a parent that was killed") {
  // Oracle: the process table. Without the reaper it would stay for ever: it hears no SIGTERM.
  const pid_t child = orphan_of_killed_parent();
  CHECK(wait_until([&] { return ::kill(child, 0) != 0; }));
}

TEST_CASE("reaper: a folder of a parent that was killed goes when its children have") {
  // Oracle: the file system, the process table.
  const palpate::ScratchFolder place;
  const auto folder = place / "folder";
  std::filesystem::create_directory(folder);
  place.write("folder/scene.yaml", "x");
  const pid_t child = orphan_of_killed_parent(folder);
  CHECK(std::filesystem::exists(folder));  // it hears no SIGTERM
  CHECK(wait_until([&] { return ::kill(child, 0) != 0; }));
  CHECK(wait_until([&] { return !std::filesystem::exists(folder); }));
}

TEST_CASE("reaper: one that is killed is told of, and the next watches whom it watched") {
  // Oracle: the process table. The child stopped hears no SIGTERM; who writes to a reaper that is
  // gone lives on.
  int told[2];
  REQUIRE(::pipe(told) == 0);
  const pid_t parent = fork();
  if (parent == 0) {
    Reaper reaper;
    std::array<pid_t, 2> children{};
    const auto add = [&](pid_t& child) {
      child = fork();
      if (child == 0) {
        execl("/bin/sh", "sh", "-c", "kill -STOP $$", nullptr);
        _exit(0);
      }
      reaper.watch(child);
    };
    add(children[0]);
    pid_t own = -1;
    std::ifstream("/proc/self/task/" + std::to_string(getpid()) + "/children") >> own;
    ::kill(own, SIGKILL);
    add(children[1]);
    std::optional<int> status;
    if (!wait_until([&] { return (status = reaper.ended()).has_value(); })) _exit(1);
    if (!WIFSIGNALED(*status) || reaper.ended()) _exit(2);
    reaper.start_again();
    if (::write(told[1], &children, sizeof children) != sizeof children) _exit(3);
    raise(SIGKILL);
  }
  close(told[1]);
  std::array<pid_t, 2> children{};
  const auto got = ::read(told[0], &children, sizeof children);
  int status = 0;
  waitpid(parent, &status, 0);
  close(told[0]);
  CAPTURE(status);
  REQUIRE(got == sizeof children);
  for (const pid_t child : children) CHECK(wait_until([&] { return ::kill(child, 0) != 0; }));
}

TEST_CASE("reaper: goes when it is let go, and ends nobody who is not its own") {
  // Oracle: the process table: a bystander lives on, and no child is left when it is gone.
  const pid_t bystander = fork();
  if (bystander == 0) {
    execl("/bin/sleep", "sleep", "60", nullptr);
    _exit(1);
  }
  const pid_t ended = fork();
  if (ended == 0) _exit(0);
  {
    Reaper reaper;
    reaper.watch(ended);
    waitpid(ended, nullptr, 0);
  }
  CHECK(waitpid(bystander, nullptr, WNOHANG) == 0);
  ::kill(bystander, SIGKILL);
  CHECK(waitpid(bystander, nullptr, 0) == bystander);
  CHECK(waitpid(-1, nullptr, WNOHANG) == -1);
}

TEST_CASE("reaper: one that is stopped keeps nobody waiting, and does not stay behind") {
  // Oracle: the clock: less than three times its patience, for whoever lets it go waits for two;
  // the process table.
  const auto began = std::chrono::steady_clock::now();
  const pid_t parent = fork();
  if (parent == 0) {
    {
      Reaper reaper;
      pid_t own = -1;
      std::ifstream("/proc/self/task/" + std::to_string(getpid()) + "/children") >> own;
      if (own <= 0 || ::kill(own, SIGSTOP) != 0) _exit(1);
    }
    _exit(waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD ? 0 : 2);
  }
  int status = -1;
  const bool ended = wait_until([&] { return waitpid(parent, &status, WNOHANG) == parent; });
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - began;
  if (!ended) ::kill(parent, SIGKILL);
  REQUIRE(ended);
  CHECK(status == 0);
  CHECK(taken.count() < 3 * Reaper::kPatience);
}
