// What the machine itself keeps of 1 kHz: a loop as haptics has it, with its priority and nothing
// in it. Runs beside a session; prints the part of its periods that had their cycle.
#include <cstdio>

#include "modules/runtime/periodic_loop.h"
#include "modules/runtime/program.h"
#include "modules/runtime/realtime.h"
#include "modules/runtime/stop_signal.h"

int main(int argc, char** argv) {
  using namespace palpate::runtime;
  constexpr double kRateHz = 1000;
  constexpr int kPriority = 80;  // as haptics
  Program program(
      "An empty loop of 1 kHz at haptics' priority, until it is stopped: its share on time.",
      "palpate-bench-empty-loop");
  return program.run(argc, argv, [] {
    const Realtime granted = request_realtime(kPriority, /*lock_memory=*/true);
    const StopSignal stop;
    PeriodicLoop loop(kRateHz);
    while (!stop.requested()) loop.wait_for_period();
    std::printf("%.3f %% on time%s\n", 100 * loop.statistics().on_time_fraction(),
                granted.priority ? "" : ", without priority");
    return 0;
  });
}
