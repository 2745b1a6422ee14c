#include "modules/runtime/worker_team.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <set>
#include <system_error>
#include <thread>
#include <vector>

#include "modules/runtime/realtime.h"

namespace palpate::runtime {
namespace {

TEST_CASE("worker team: each chunk is done once, in every run") {
  // Oracle: counting, for more and fewer chunks than threads, many runs in a row.
  for (const std::size_t threads : {1u, 2u, 3u, 5u}) {
    WorkerTeam team(threads);
    CHECK(team.size() == threads);
    for (int run = 0; run < 2000; ++run) {
      const std::size_t count = static_cast<std::size_t>(run) % 9;
      std::vector<std::atomic<int>> done(count);
      team.run(count, [&](std::size_t chunk) { ++done[chunk]; });
      for (const auto& times : done) REQUIRE(times == 1);
    }
  }
}

TEST_CASE("worker team: what the chunks wrote is seen after the run") {
  // Oracle: a sum over plain memory; the thread sanitizer has its own opinion of this test.
  WorkerTeam team(3);
  std::vector<long> part(64);
  long total = 0;
  for (long run = 1; run <= 500; ++run) {
    team.run(part.size(), [&](std::size_t chunk) { part[chunk] = run; });
    for (const long value : part) total += value;
  }
  CHECK(total == 64L * 500 * 501 / 2);
}

TEST_CASE("worker team: a sleeping team wakes") {
  // Oracle: the run returns only when all chunks are done; 20 ms is far beyond the spinning.
  WorkerTeam team(2);
  for (int run = 0; run < 5; ++run) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    std::atomic<int> done{0};
    team.run(10, [&](std::size_t) { ++done; });
    CHECK(done == 10);
  }
}

TEST_CASE("worker team: more than one thread takes part where there is enough to do") {
  // Oracle: thread ids; a chunk waits until another thread has begun one, so it cannot be missed.
  WorkerTeam team(2);
  std::atomic<int> begun{0};
  std::vector<std::thread::id> ids(2);
  team.run(2, [&](std::size_t chunk) {
    ids[chunk] = std::this_thread::get_id();
    ++begun;
    while (begun < 2) std::this_thread::yield();
  });
  CHECK(ids[0] != ids[1]);
}

TEST_CASE(
    "worker team: each thread begins with its own part of the chunks, the same in every run") {
  // Oracle: thread ids. The first chunks that are begun wait for each other, so that neither thread
  // can take the other's part for want of him.
  WorkerTeam team(2);
  std::thread::id worker;
  for (int run = 0; run < 50; ++run) {
    std::atomic<int> begun{0};
    std::vector<std::thread::id> ids(9);
    team.run(ids.size(), [&](std::size_t chunk) {
      ids[chunk] = std::this_thread::get_id();
      ++begun;
      while (begun < 2) std::this_thread::yield();
    });
    if (run == 0) worker = ids[4];
    CHECK(ids[0] == std::this_thread::get_id());
    CHECK(ids[4] == worker);
    CHECK(worker != ids[0]);
  }
}

TEST_CASE("worker team: who is done with his part takes from another's") {
  // Oracle: one chunk ends only after all others have, whosesoever they are.
  WorkerTeam team(3);
  for (const std::size_t last : {0u, 5u, 11u}) {
    std::atomic<int> done{0};
    team.run(12, [&](std::size_t chunk) {
      while (chunk == last && done < 11) std::this_thread::yield();
      ++done;
    });
    CHECK(done == 12);
  }
}

#if !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)  // which need more than any limit
TEST_CASE("worker team: threads that the system does not give are an error, not the end") {
  // Oracle: a limit on memory, in a process of its own, under which some of 200 stacks of 8 MiB
  // fit; what is thrown. The first threads ended the program: "terminate called".
  const pid_t process = ::fork();
  if (process == 0) {
    const rlimit most{500'000'000, 500'000'000}, stack{8u << 20, 8u << 20};
    ::setrlimit(RLIMIT_STACK, &stack);
    ::setrlimit(RLIMIT_AS, &most);
    try {
      const WorkerTeam team(200);
    } catch (const std::system_error&) {
      ::_exit(0);
    }
    ::_exit(1);
  }
  int status = 0;
  ::waitpid(process, &status, 0);
  CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
}
#endif

TEST_CASE("worker team: as many threads as cores keep to one each, others to none") {
  // Oracle: the cores that the scheduler allows each thread; in a process of its own, which they
  // stay with. A chunk waits until all have begun, so each thread does one.
  const pid_t child = fork();
  if (child == 0) {
    cpu_set_t all;
    sched_getaffinity(0, sizeof all, &all);
    const auto cores = static_cast<std::size_t>(CPU_COUNT(&all));
    const auto cores_of_threads = [&](std::size_t threads, bool leaves_first = false) {
      WorkerTeam team(threads);
      if (leaves_first && cores > 1 && !leave_first_core(cores)) _exit(3);
      team.keep_to_own_cores();
      std::atomic<std::size_t> begun{0};
      std::vector<cpu_set_t> allowed(threads);
      team.run(threads, [&](std::size_t chunk) {
        sched_getaffinity(0, sizeof(cpu_set_t), &allowed[chunk]);
        ++begun;
        while (begun < threads) std::this_thread::yield();
      });
      std::set<int> together;
      std::size_t sum = 0;
      for (const cpu_set_t& set : allowed) {
        sum += static_cast<std::size_t>(CPU_COUNT(&set));
        for (int core = 0; core < CPU_SETSIZE; ++core) {
          if (CPU_ISSET(core, &set)) together.insert(core);
        }
      }
      return std::pair(sum, together.size());
    };
    if (cores_of_threads(cores + 1) != std::pair((cores + 1) * cores, cores)) _exit(1);
    // Its other threads have left the first core, as the bus' threads of deformation do.
    _exit(cores_of_threads(cores, true) == std::pair(cores, cores) ? 0 : 2);
  }
  int status = 0;
  waitpid(child, &status, 0);
  CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
}

}  // namespace
}  // namespace palpate::runtime
