#include "modules/runtime/thread_time.h"

#include <time.h>

#include <catch2/catch.hpp>

#include "modules/runtime/clock.h"

TEST_CASE("thread time: it does not pass while a thread sleeps") {
  // Oracle: the monotonic clock, which does; half of the sleep is far above what waking takes.
  using namespace palpate::runtime;
  const std::int64_t before = thread_time_ns(), begin = monotonic_now_ns();
  const timespec pause{0, 20'000'000};
  nanosleep(&pause, nullptr);
  CHECK(monotonic_now_ns() - begin >= 20'000'000);
  CHECK(thread_time_ns() >= before);
  CHECK(thread_time_ns() - before < 10'000'000);
}
