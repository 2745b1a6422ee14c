#include "modules/runtime/stolen_time.h"

#include <catch2/catch.hpp>

using palpate::runtime::stolen_time;

TEST_CASE("stolen time: the eighth number of the first line, in ticks") {
  // Oracle: man 5 proc, by hand.
  CHECK(stolen_time("cpu  10 20 30 40 50 60 70 250 90 100\ncpu0 1 2 3 4 5 6 7 8 9 10\n", 100) ==
        2.5);
  CHECK(stolen_time("cpu  10 20 30\n", 100) == 0);
  CHECK(stolen_time("intr 10 20 30 40 50 60 70 250\n", 100) == 0);
  CHECK(stolen_time("", 100) == 0);
}

TEST_CASE("stolen time: of this machine it never falls") {
  // Oracle: definition.
  const double before = stolen_time();
  CHECK(before >= 0);
  CHECK(stolen_time() >= before);
}
