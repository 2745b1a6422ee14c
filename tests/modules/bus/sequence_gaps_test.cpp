#include "modules/bus/sequence_gaps.h"

#include <catch2/catch.hpp>

namespace palpate::bus {
namespace {

WriterId writer(unsigned char name) {
  WriterId id{};
  id[0] = name;
  return id;
}

}  // namespace

TEST_CASE("sequence gaps: counted from the first sample of each writer", "[bus]") {
  // Oracle: counts by hand.
  SequenceGaps gaps;
  CHECK(gaps.dropped() == 0);
  gaps.count(writer(1), 100);
  gaps.count(writer(1), 101);
  CHECK(gaps.dropped() == 0);
  gaps.count(writer(1), 105);  // 102, 103, 104
  gaps.count(writer(2), 7);
  gaps.count(writer(2), 9);  // 8
  CHECK(gaps.dropped() == 4);
}

TEST_CASE("sequence gaps: a late sample of another key closes its gap", "[bus]") {
  // Oracle: counts by hand.
  SequenceGaps gaps;
  gaps.count(writer(1), 1);
  gaps.count(writer(1), 3);
  CHECK(gaps.dropped() == 1);
  gaps.count(writer(1), 2);
  CHECK(gaps.dropped() == 0);
}

TEST_CASE("sequence gaps: samples from before the first do not count", "[bus]") {
  // Oracle: counts by hand; a late joiner gets the newest of each key in any order.
  SequenceGaps gaps;
  gaps.count(writer(1), 10);
  gaps.count(writer(1), 4);
  CHECK(gaps.dropped() == 0);
  gaps.count(writer(1), 12);
  CHECK(gaps.dropped() == 1);
}

TEST_CASE("sequence gaps: what forgotten writers dropped stays counted", "[bus]") {
  // Oracle: each of 100 writers leaves a gap of one; more than can be known at a time.
  SequenceGaps gaps;
  for (unsigned char name = 1; name <= 100; ++name) {
    gaps.count(writer(name), 1);
    gaps.count(writer(name), 3);
  }
  CHECK(gaps.dropped() == 100);
}

}  // namespace palpate::bus
