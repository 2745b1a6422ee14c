#include "modules/bus/wall_clock_shift.h"

#include <catch2/catch.hpp>
#include <random>

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

}  // namespace palpate::bus
