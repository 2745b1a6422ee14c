#include "modules/runtime/stolen_time.h"

#include <catch2/catch.hpp>

using palpate::runtime::core_ticks;
using palpate::runtime::CoreTicks;
using palpate::runtime::stolen_share;

TEST_CASE("stolen time: the eighth number of the first line, of the sum of eight") {
  // Oracle: man 5 proc, by hand; the ninth and tenth are part of the first two.
  const CoreTicks ticks =
      core_ticks("cpu  10 20 30 40 50 60 70 250 90 100\ncpu0 1 2 3 4 5 6 7 8 9 10\n");
  CHECK(ticks.stolen == 250);
  CHECK(ticks.all == 530);
  for (const char* none : {"cpu  10 20 30\n", "intr 10 20 30 40 50 60 70 250\n", ""}) {
    CHECK(core_ticks(none).stolen == 0);
    CHECK(core_ticks(none).all == 0);
  }
}

TEST_CASE("stolen time: a share of what passed") {
  // Oracle: definition, by hand.
  CHECK(stolen_share({250, 1000}, {300, 1200}) == 0.25);
  CHECK(stolen_share({250, 1000}, {250, 1000}) == 0);
}

TEST_CASE("stolen time: of this machine it never falls") {
  // Oracle: definition.
  const CoreTicks before = core_ticks(), after = core_ticks();
  CHECK(before.all > 0);
  CHECK(after.stolen >= before.stolen);
  CHECK(after.all >= before.all);
}
