#include "palpate/hang_watch.h"

#include <catch2/catch.hpp>

using palpate::launcher::HangWatch;

TEST_CASE(
    "hang watch: who is silent and idle hangs after three seconds, who computes may take long") {
  // Oracle: the stated limits; looked at ten times a second.
  const auto found_after = [](double cpu_share) {
    HangWatch watch;
    double time = 0;
    while (watch.hangs_for("m", 7, cpu_share * time, std::int64_t(1e9 * (100 + time))) == 0) {
      time += 0.1;
    }
    return time;
  };
  CHECK(found_after(0) == Approx(HangWatch::kIdle).margin(0.11));
  CHECK(found_after(0.01) == Approx(HangWatch::kIdle).margin(0.11));
  CHECK(found_after(0.9) == Approx(HangWatch::kComputing).margin(0.11));
}

TEST_CASE("hang watch: news end a silence, and a pause of the listener is none") {
  // Oracle: definition.
  HangWatch watch;
  const auto at = [](double s) { return std::int64_t(1e9 * (100 + s)); };
  for (double t = 0; t < 10; t += 0.1) {
    CHECK(watch.hangs_for("m", std::uint64_t(t), 0, at(t)) == 0);
  }
  CHECK(watch.hangs_for("m", 9, 0, at(500)) == 0);
}

TEST_CASE("hang watch: who has not said a word may load for a minute, and each life counts alone") {
  // Oracle: the stated limits. A successor's first status may bear its predecessor's number.
  HangWatch watch;
  double time = 0;
  const auto hangs = [&](const char* process, std::uint64_t sequence) {
    time += 0.1;
    return watch.hangs_for(process, sequence, 0, std::int64_t(1e9 * (100 + time))) > 0;
  };
  while (!hangs("m 1", 0)) {
  }
  CHECK(time == Approx(HangWatch::kLoading).margin(0.3));
  while (!hangs("m 2", 1)) {
  }
  CHECK_FALSE(hangs("m 3", 1));
}
