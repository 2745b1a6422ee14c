#include "haptics/devices/driver_clock.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "tests/times.h"

using namespace palpate;
using haptics::DriverClock;

namespace {

constexpr std::int64_t kBegin = 50'000 * kSecond;  ///< this host's clock

}  // namespace

TEST_CASE("driver clock: a stamp of this host's clock is taken as it is, however late it comes") {
  // Oracle: definition; 0 to 0.1 s late, and stamped up to 2 ms after the hearing cycle began.
  DriverClock clock;
  std::int64_t stamp = kBegin;
  for (const std::int64_t late : {kMs / 5, 30 * kMs, 99 * kMs, kMs}) {
    stamp += kSecond;
    CHECK(clock.hear(stamp, stamp + late) == stamp);
  }
  stamp += kSecond;
  CHECK(clock.hear(stamp, stamp - kMs) == stamp - kMs);  // no later than it is heard
}

TEST_CASE("driver clock: without stamps a sample is as old as its hearing") {
  // Oracle: definition.
  DriverClock clock;
  CHECK(clock.hear(0, kBegin) == kBegin);
  CHECK(clock.hear(-1, kBegin + kMs) == kBegin + kMs);
}

TEST_CASE("driver clock: stamps of another clock count from the fastest sample") {
  // Oracle: analytic. A clock that began elsewhere; delays of 3 ms and more, the least among them:
  // after it, each sample is its delay above the least old.
  const std::int64_t began = GENERATE(kSecond, 40'000 * kSecond, 90'000 * kSecond);
  DriverClock clock;
  const auto heard = [&](std::int64_t sampled, std::int64_t delay) {
    const auto mapped = clock.hear(began + sampled - kBegin, sampled + delay);
    return mapped ? sampled + delay - *mapped : -1;
  };
  CHECK(heard(kBegin + 1 * kMs, 7 * kMs) == 0);
  CHECK(heard(kBegin + 2 * kMs, 3 * kMs) == 0);
  CHECK(heard(kBegin + 3 * kMs, 8 * kMs) == 5 * kMs);
  CHECK(heard(kBegin + 4 * kMs, 3 * kMs) == 0);
  CHECK(heard(kBegin + 5 * kMs, 63 * kMs) == 60 * kMs);
}

TEST_CASE("driver clock: a clock that runs 100 ppm slow or fast is followed") {
  // Oracle: analytic. Within two windows of a second it goes wrong by 0.2 ms, after an hour by
  // 360 ms. Samples every 10 ms, each 1 ms on its way.
  const int ppm = GENERATE(-100, 100);
  DriverClock clock;
  std::int64_t worst = 0;
  for (std::int64_t i = 1; i <= 360'000; ++i) {
    const std::int64_t elapsed = 10 * kMs * i;
    const std::int64_t stamp = 7 * kSecond + elapsed + elapsed / 1'000'000 * ppm;
    const std::int64_t now = kBegin + elapsed + kMs;
    worst = std::max(worst, now - clock.hear(stamp, now).value_or(0));
  }
  CHECK(worst <= kMs / 5 + 1000);
}

TEST_CASE("driver clock: a stamp not later than the one before is old, until it is forgotten") {
  // Oracle: definition. A driver started again may begin at an earlier time.
  DriverClock clock;
  CHECK(clock.hear(kBegin, kBegin));
  CHECK_FALSE(clock.hear(kBegin, kBegin + kMs));
  CHECK_FALSE(clock.hear(kBegin - kSecond, kBegin + 2 * kMs));
  CHECK(clock.hear(kBegin + kMs, kBegin + 3 * kMs));
  clock.forget();
  CHECK(clock.hear(5 * kMs, kBegin + 4 * kMs) == kBegin + 4 * kMs);
}

TEST_CASE("driver clock: any stamp whatever gives a time that is not in the future") {
  // Oracle: invariant; the greatest stamp there is makes all others old, nothing worse.
  DriverClock clock;
  CHECK(*clock.hear(1, kBegin) <= kBegin);
  CHECK(*clock.hear(std::numeric_limits<std::int64_t>::max(), kBegin + kMs) <= kBegin + kMs);
  CHECK_FALSE(clock.hear(kBegin, kBegin + 2 * kMs));
}
