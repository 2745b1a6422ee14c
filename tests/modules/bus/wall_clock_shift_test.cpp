#include "modules/bus/wall_clock_shift.h"

#include <catch2/catch.hpp>
#include <random>
#include <utility>
#include <vector>

namespace palpate::bus {

TEST_CASE("wall clock shift: pauses between readings do not change it, a clock that was set does") {
  // Oracle: two made clocks, whose shift is known; readings 20 ns apart, some by a pause of up to
  // 50 ms.
  std::mt19937 random(1);
  WallClockShift shift;
  std::int64_t now = 1'000'000, ahead = -1'700'000'000'000'000'000;
  const auto pass = [&] {
    now += 20;
    if (random() % 4 == 0) now += static_cast<std::int64_t>(random() % 50'000'000);
  };
  const auto read = [&] {
    const std::int64_t before = now;
    pass();
    const std::int64_t wall = now - ahead;
    pass();
    return shift.take(before, wall, now);
  };
  for (const std::int64_t set_by : {std::int64_t{0}, 3'600'000'000'000, std::int64_t{-5'000'000}}) {
    ahead += set_by;
    for (int k = 0; k < 50; ++k) read();
    const std::int64_t known = read();
    CHECK(std::abs(known - ahead) <= 20);
    for (int k = 0; k < 1000; ++k) REQUIRE(read() == known);
  }
}

TEST_CASE("wall clock shift: what arrived before the wall clock was set is not moved by it") {
  // Oracle: two made clocks. Arrivals every millisecond, read ten at a time; the wall clock is set
  // between the arrival and the reading of some.
  constexpr std::int64_t kMs = 1'000'000;
  for (const std::int64_t set_by : {86'400'000 * kMs, -86'400'000 * kMs, 5'000 * kMs, -200 * kMs}) {
    CAPTURE(set_by);
    WallClockShift shift;
    std::int64_t now = 50 * kMs, wall = 1'700'000'000'000'000'000, last = 0;
    shift.nothing_waits(now);
    for (int batch = 0; batch < 20; ++batch) {
      std::vector<std::pair<std::int64_t, std::int64_t>> waiting;  // arrival, its stamp
      for (int k = 0; k < 10; ++k) {
        waiting.emplace_back(now, wall);
        now += kMs, wall += kMs;
        if (batch == 10 && k == 5) wall += set_by;
      }
      for (const auto& [arrived, stamp] : waiting) {
        const std::int64_t told = shift.arrival(stamp, now, wall, now);
        REQUIRE(std::abs(told - arrived) <= (batch == 10 ? 10 * kMs : 0));
        REQUIRE(told >= last);
        last = told;
      }
      shift.nothing_waits(now);
    }
  }
}

}  // namespace palpate::bus
