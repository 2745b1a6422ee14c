#include "modules/runtime/thread_time.h"

#include <time.h>

#include "modules/core/units.h"

namespace palpate::runtime {

std::int64_t thread_time_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return now.tv_sec * kNanosecondsPerSecond + now.tv_nsec;
}

}  // namespace palpate::runtime
