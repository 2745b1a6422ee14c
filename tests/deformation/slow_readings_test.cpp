#include "deformation/slow_readings.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

/// When each of them was read last.
struct SlowClock {
  explicit SlowClock(double every) : readings(2, every) {}
  void look(double time) {
    readings.look(time, [&](std::size_t i) {
      ++count;
      return time + static_cast<double>(i);
    });
  }
  SlowReadings readings;
  int count = 0;
};

}  // namespace

TEST_CASE("slow readings: all are read at first, and then when it is time") {
  // Oracle: the times asked for; 0.04 s are not over at 0.039, and are at 0.04.
  SlowClock clock(0.04);
  CHECK(clock.readings.of(1) == 0);
  for (const auto& [time, read] : {std::pair{0.0, 0.0},
                                   {0.01, 0.0},
                                   {0.039, 0.0},
                                   {0.04, 0.04},
                                   {0.079, 0.04},
                                   {0.2, 0.2},
                                   {0.239, 0.2}}) {
    clock.look(time);
    CHECK(clock.readings.of(0) == read);
    CHECK(clock.readings.of(1) == read + 1);
  }
  CHECK(clock.count == 6);
}

TEST_CASE("slow readings: times that are sums of periods are read as often as their sum says") {
  // Oracle: so many whole periods; 0.09 + 0.04 is more than thirteen times 0.01 added up.
  for (const auto& [rate, periods] :
       {std::pair{100.0, 4}, {250.0, 10}, {50.0, 2}, {1000.0, 40}, {70.0, 3}, {10.0, 1}}) {
    SlowClock clock(0.04);
    double time = 0;
    constexpr int kReadings = 200;
    for (int k = 0; k < kReadings * periods; ++k, time += 1 / rate) clock.look(time);
    INFO(rate << " Hz");
    CHECK(clock.count == 2 * kReadings);
  }
}

TEST_CASE("slow readings: time that begins anew is time to read") {
  // Oracle: the time asked for.
  SlowClock clock(0.04);
  clock.look(5);
  clock.look(0.01);
  CHECK(clock.readings.of(0) == 0.01);
}

TEST_CASE("slow readings: who goes on from a state reads when its writer would have") {
  // Oracle: the same readings without the interruption; a state of others is refused.
  SlowClock before(0.04), after(0.04);
  before.look(0.1);
  StateArchive written;
  before.readings.exchange(written);
  StateArchive read(written.bytes());
  after.readings.exchange(read);
  for (const double time : {0.12, 0.139, 0.14}) {
    before.look(time);
    after.look(time);
    CHECK(after.readings.of(0) == before.readings.of(0));
  }
  CHECK(after.count == 2);
  SlowReadings others(3, 0.04);
  StateArchive again(written.bytes());
  CHECK_THROWS_AS(others.exchange(again), InputError);
}

}  // namespace palpate::deformation
