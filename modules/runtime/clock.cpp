#include "modules/runtime/clock.h"

#include <time.h>

#include "modules/core/units.h"

namespace palpate::runtime {
namespace {

std::int64_t now_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return now.tv_sec * kNanosecondsPerSecond + now.tv_nsec;
}

}  // namespace

std::int64_t monotonic_now_ns() { return now_ns(CLOCK_MONOTONIC); }

std::int64_t thread_time_ns() { return now_ns(CLOCK_THREAD_CPUTIME_ID); }

}  // namespace palpate::runtime
