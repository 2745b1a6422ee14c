#include "modules/runtime/realtime.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <thread>

#include "modules/core/temporary_folder.h"

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

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
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

TEST_CASE("realtime: cores are kept awake while it is asked for, and not longer") {
  // Oracle: what stands in a file in the kernel's place: 0 microseconds, as Linux documents it; and
  // the number of files that are open.
  const palpate::TemporaryFolder folder;
  const auto file = folder.write("latency", "....");
  const auto open_files = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
  };
  const auto before = open_files();
  {
    const AwakeCores cores(file.c_str());
    CHECK(cores.refused().empty());
    CHECK(text_of(file) == "....");
    CHECK(open_files() == before + 1);
    cores.keep();
    CHECK(text_of(file) == std::string(4, '\0'));
  }
  CHECK(open_files() == before);
}

TEST_CASE("realtime: cores that may sleep are told where that could be granted, and only there") {
  // Oracle: a file that nobody may write to as a file, and one that is not there.
  CHECK(in_child([] {
          const AwakeCores none("/nowhere/cpu_dma_latency"), folder("/proc/self");
          none.keep();
          folder.keep();
          const std::string refused = folder.refused();
          const bool says = refused.find("/proc/self") != std::string::npos &&
                            refused.find('\n') == std::string::npos;
          return none.refused().empty() && says ? 0 : 1;
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

TEST_CASE("realtime: who takes turns is no longer preferred when woken, unless it has priority") {
  // Oracle: the scheduler's own answer, for a thread started afterwards, too.
  CHECK(in_child([] {
          const bool prioritized = request_realtime(10, false).priority;
          wait_for_turn();
          if (prioritized && sched_getscheduler(0) != SCHED_FIFO) return 1;
          give_up_realtime();
          wait_for_turn();
          int inherited = -1;
          std::thread([&] { inherited = sched_getscheduler(0); }).join();
          return sched_getscheduler(0) == SCHED_BATCH && inherited == SCHED_BATCH ? 0 : 2;
        }) == 0);
}

TEST_CASE("realtime: as many processes as cores keep to one each, other numbers of them to none") {
  // Oracle: the cores that the scheduler says it allows, for a thread started afterwards, too.
  CHECK(in_child([] {
          cpu_set_t all, own, inherited;
          sched_getaffinity(0, sizeof all, &all);
          const auto cores = static_cast<std::size_t>(CPU_COUNT(&all));
          if (keep_to_own_core(0, cores + 1)) return 1;
          sched_getaffinity(0, sizeof own, &own);
          if (!CPU_EQUAL(&own, &all)) return 2;
          if (!keep_to_own_core(cores - 1, cores)) return 3;
          sched_getaffinity(0, sizeof own, &own);
          std::thread([&] { sched_getaffinity(0, sizeof inherited, &inherited); }).join();
          int last = 0;
          for (int core = 0; core < CPU_SETSIZE; ++core) {
            if (CPU_ISSET(core, &all)) last = core;
          }
          const bool kept = CPU_COUNT(&own) == 1 && CPU_ISSET(last, &own);
          return kept && CPU_EQUAL(&own, &inherited) ? 0 : 4;
        }) == 0);
}

TEST_CASE("realtime: who leaves the first core has all others, where there are so many") {
  // Oracle: the cores that the scheduler says it allows, for a thread started afterwards, too.
  CHECK(in_child([] {
          cpu_set_t all, left, inherited, own;
          sched_getaffinity(0, sizeof all, &all);
          const auto cores = static_cast<std::size_t>(CPU_COUNT(&all));
          if (leave_first_core(cores + 1)) return 1;
          sched_getaffinity(0, sizeof left, &left);
          if (!CPU_EQUAL(&left, &all)) return 2;
          if (cores == 1) return leave_first_core(1) ? 3 : 0;
          if (!leave_first_core(cores)) return 4;
          sched_getaffinity(0, sizeof left, &left);
          std::thread([&] { sched_getaffinity(0, sizeof inherited, &inherited); }).join();
          int first = 0;
          while (!CPU_ISSET(first, &all)) ++first;
          CPU_ZERO(&own);
          CPU_SET(first, &own);
          CPU_XOR(&all, &all, &own);
          return CPU_EQUAL(&left, &all) && CPU_EQUAL(&left, &inherited) ? 0 : 5;
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
