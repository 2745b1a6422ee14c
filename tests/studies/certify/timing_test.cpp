#include "studies/certify/timing.h"

#include <catch2/catch.hpp>

using namespace palpate::certify;

TEST_CASE("certify timing: a loop that misses ticks, or answers late, fails the lines of that") {
  // Oracle: definition. Of 10,000 periods 20 are doubled: 99.8 % on time, and 0.2 % of periods are
  // long; latencies are 2 ms.
  Timing timing;
  timing.periods.assign(10'000, 1e-3);
  std::fill_n(timing.periods.begin(), 20, 2.1e-3);
  timing.latencies.assign(10'000, 2e-3);
  timing.cycles = 9980;
  timing.overruns = 20;
  for (const Line& line : timing_lines("timing", timing, 1e-3)) {
    INFO(text_of(line));
    const bool broken = line.name == "loop period, p99.9" || line.name == "ticks on time" ||
                        (line.name.starts_with("pose to force") && !line.name.ends_with("max"));
    CHECK((line.verdict == Verdict::kFail) == broken);
  }
  for (const Line& line : timing_lines("timing", {}, 1e-3))
    CHECK(line.verdict == Verdict::kNotMeasured);
}
