#include "modules/runtime/realtime.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <functional>

using namespace palpate::runtime;

namespace {

/// Exit code of `job` in a process of its own: what it asks for must not stay with the tests.
int in_child(const std::function<int()>& job) {
  const pid_t child = fork();
  if (child == 0) _exit(job());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

TEST_CASE("realtime: says what the system granted") {
  // Oracle: the scheduler's own answer.
  CHECK(in_child([] {
          const Realtime granted = request_realtime(10, true);
          const bool is_fifo = sched_getscheduler(0) == SCHED_FIFO;
          if (granted.priority != is_fifo) return 1;
          const bool all = granted.priority && granted.memory_locked;
          return all == granted.refused.empty() ? 0 : 2;
        }) == 0);
}

TEST_CASE("realtime: where it is not granted, one line says what would grant it") {
  // Oracle: a process without privileges and without limits that allow it.
  CHECK(in_child([] {
          const rlimit none{0, 0};
          setrlimit(RLIMIT_RTPRIO, &none);
          setrlimit(RLIMIT_MEMLOCK, &none);
          if (geteuid() == 0 && setuid(65534) != 0) return 0;  // cannot become nobody here
          const Realtime granted = request_realtime(10, true);
          if (granted.priority || granted.memory_locked) return 1;
          const bool one_line = granted.refused.find('\n') == std::string::npos;
          const bool helps = granted.refused.find("ulimit -r") != std::string::npos &&
                             granted.refused.find("ulimit -l") != std::string::npos;
          return one_line && helps ? 0 : 2;
        }) == 0);
}

TEST_CASE("realtime: can be given up, and asked for without locked memory") {
  // Oracle: the scheduler's own answer.
  CHECK(in_child([] {
          const Realtime granted = request_realtime(10, false);
          if (granted.memory_locked) return 1;
          give_up_realtime();
          return sched_getscheduler(0) == SCHED_OTHER ? 0 : 2;
        }) == 0);
}

TEST_CASE("realtime: a background process gives way") {
  // Oracle: the system's niceness.
  CHECK(in_child([] {
          const int before = getpriority(PRIO_PROCESS, 0);
          lower_priority(7);
          return getpriority(PRIO_PROCESS, 0) - before;
        }) == 7);
}
