#include "modules/runtime/clock.h"

#include <time.h>

#include "modules/core/units.h"

namespace palpate::runtime {

std::int64_t thread_time_ns() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return time.tv_sec * kNanosecondsPerSecond + time.tv_nsec;
}

}  // namespace palpate::runtime
