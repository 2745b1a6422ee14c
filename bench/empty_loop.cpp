// What the machine itself keeps of 1 kHz: a loop as haptics has it, with its priority, cores awake
// and nothing in it. Runs beside a session; prints the part of its periods that had their cycle,
// and of the others why: the loop was awake in time and waited for a processor, which the kernel or
// somebody of its priority held, or its timer came late, for the host had taken the processor away.
#include <cstdio>
#include <fstream>

#include "modules/core/stop_signal.h"
#include "modules/runtime/periodic_loop.h"
#include "modules/runtime/program.h"
#include "modules/runtime/realtime.h"

namespace {

/// How long this thread has been ready and not running, in all [ns]; 0 where the kernel does not
/// say.
std::int64_t waited_ns() {
  std::ifstream file("/proc/thread-self/schedstat");
  std::int64_t ran = 0, waited = 0;
  file >> ran >> waited;
  return waited;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace palpate::runtime;
  constexpr double kRateHz = 1000;
  constexpr int kPriority = 80;  // as haptics
  Program program(
      "An empty loop of 1 kHz at haptics' priority, until it is stopped: its share on time.",
      "palpate-bench-empty-loop");
  bool cores_may_sleep = false;
  program.flag("--cores-may-sleep", cores_may_sleep,
               "Do not keep idle cores awake, as haptics does");
  return program.run(argc, argv, [&] {
    const Realtime granted = request_realtime(kPriority, /*lock_memory=*/true);
    const AwakeCores cores;
    if (!cores_may_sleep) cores.keep();
    const palpate::StopSignal stop;
    PeriodicLoop loop(kRateHz);
    std::int64_t waited_before_ns = waited_ns();
    std::uint64_t missed = 0, waiting = 0;
    while (!stop.requested()) {
      loop.wait_for_period();
      const std::int64_t now_ns = waited_ns(),
                         overslept_ns = loop.woke_ns() - loop.period_began_ns();
      const std::uint64_t more = loop.statistics().overruns - missed;
      missed += more;
      const std::int64_t late_ns =
          overslept_ns + static_cast<std::int64_t>(more) * loop.period_ns();
      if (2 * (now_ns - waited_before_ns) > late_ns) waiting += more;
      waited_before_ns = now_ns;
    }
    std::printf("%.3f %% on time, of %llu missed %llu waiting for a processor%s%s\n",
                100 * loop.statistics().on_time_fraction(), static_cast<unsigned long long>(missed),
                static_cast<unsigned long long>(waiting),
                granted.priority ? "" : ", without priority",
                cores_may_sleep || !cores.refused().empty() ? ", cores may sleep" : "");
    return 0;
  });
}
