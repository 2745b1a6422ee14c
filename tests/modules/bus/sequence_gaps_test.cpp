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

TEST_CASE("sequence gaps: a number that leaps beyond what can be missed is no loss", "[bus]") {
  // Oracle: counts by hand. One sample numbered 2^64 - 5 made 18446744073709551609 of them.
  SequenceGaps gaps;
  gaps.count(writer(1), 1);
  gaps.count(writer(1), 4);  // 2, 3
  gaps.count(writer(1), ~std::uint64_t{0} - 4);
  CHECK(gaps.dropped() == 2);
  gaps.count(writer(1), ~std::uint64_t{0} - 2);  // one, and it goes on from there
  CHECK(gaps.dropped() == 3);
  gaps.count(writer(1), 5);
  CHECK(gaps.dropped() == 3);
  gaps.count(writer(2), 1);
  gaps.count(writer(2), 1 + SequenceNumbers::kFarthestLeap);  // all but the two
  CHECK(gaps.dropped() == 3 + SequenceNumbers::kFarthestLeap - 1);
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
