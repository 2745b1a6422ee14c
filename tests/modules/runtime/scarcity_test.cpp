#include "modules/runtime/scarcity.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <cerrno>
#include <csignal>
#include <functional>
#include <new>
#include <stdexcept>

#include "modules/core/error.h"

namespace palpate::runtime {
namespace {

struct Ended {
  int status = 0;
  std::string said;
};

/// How a program ends that throws where nobody catches it.
Ended end_of(const std::function<void()>& body) {
  std::array<int, 2> ends{};
  REQUIRE(::pipe(ends.data()) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(ends[1], STDERR_FILENO);
    std::signal(SIGABRT, SIG_DFL);  // the test's own handler speaks, too
    end_in_words("palpate-test");
    [&]() noexcept { body(); }();
    ::_exit(0);
  }
  ::close(ends[1]);
  Ended ended;
  std::array<char, 4096> block{};
  for (ssize_t got; (got = ::read(ends[0], block.data(), block.size())) > 0;) {
    ended.said.append(block.data(), static_cast<std::size_t>(got));
  }
  ::close(ends[0]);
  REQUIRE(::waitpid(child, &ended.status, 0) == child);
  return ended;
}

TEST_CASE("scarcity: what nobody can catch ends a program in one line, with exit code 1") {
  // Oracle: the exit codes of core/error.h; the line. Both were "terminate called …" and SIGABRT.
  const Ended memory = end_of([] { throw std::bad_alloc(); });
  CHECK(WIFEXITED(memory.status));
  CHECK(WEXITSTATUS(memory.status) == kExitFailed);
  CHECK(memory.said == "palpate-test: not enough memory\n");

  const Ended thread = end_of([] { throw std::system_error(EINVAL, std::generic_category()); });
  CHECK(WIFEXITED(thread.status));
  CHECK(WEXITSTATUS(thread.status) == kExitFailed);
  CHECK(thread.said.find("palpate-test: no thread can be started") == 0);
  CHECK(thread.said.find('\n') == thread.said.size() - 1);
}

TEST_CASE("scarcity: a fault of ours still aborts") {
  // Oracle: the signal of abort().
  const Ended fault = end_of([] { throw std::logic_error("a fault"); });
  CHECK(WIFSIGNALED(fault.status));
  CHECK(fault.said.find("a fault") != std::string::npos);
}

TEST_CASE("scarcity: a thread that is not given is called one") {
  // Oracle: the words; those of another error are the system's.
  const std::system_error thread(EAGAIN, std::generic_category());
  CHECK(why(thread).find("cannot start a thread: Resource temporarily unavailable; ulimit -u") ==
        0);
  const std::system_error other(ENOENT, std::generic_category());
  CHECK(why(other) == other.what());
}

}  // namespace
}  // namespace palpate::runtime
