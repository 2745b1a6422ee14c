#include "modules/runtime/silence_watch.h"

#include <catch2/catch.hpp>

using palpate::runtime::SilenceWatch;

TEST_CASE("silence watch: a source is silent until heard, and again after the limit") {
  // Oracle: definition, limit 50 ms.
  SilenceWatch watch(2, 0.05);
  CHECK(watch.silent(0, 1'000'000'000));
  watch.heard(0, 1'000'000'000);
  CHECK_FALSE(watch.silent(0, 1'000'000'000));
  CHECK_FALSE(watch.silent(0, 1'050'000'000));
  CHECK(watch.silent(0, 1'050'000'001));
  CHECK(watch.silent(1, 1'000'000'000));
}

TEST_CASE("silence watch: an old sample that comes late does not make a source young") {
  // Oracle: a stopped reader that resumes gets old samples after newer ones of another path.
  SilenceWatch watch(1, 0.05);
  watch.heard(0, 2'000'000'000);
  watch.heard(0, 1'000'000'000);
  CHECK_FALSE(watch.silent(0, 2'040'000'000));
  SilenceWatch late(1, 0.05);
  late.heard(0, 1'000'000'000);
  CHECK(late.silent(0, 6'000'000'000));
}

TEST_CASE("silence watch: one silent source of several is noticed, unknown ones are nobody's") {
  // Oracle: definition.
  SilenceWatch watch(2, 0.05);
  watch.heard(7, 1'000'000'000);
  watch.heard(0, 1'000'000'000);
  CHECK(watch.any_silent(1'000'000'000));
  watch.heard(1, 1'000'000'000);
  CHECK_FALSE(watch.any_silent(1'000'000'000));
}
