#include "modules/runtime/clock.h"

#include <time.h>

#include "modules/core/units.h"

namespace palpate::runtime {

std::int64_t monotonic_now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kNanosecondsPerSecond + now.tv_nsec;
}

}  // namespace palpate::runtime
