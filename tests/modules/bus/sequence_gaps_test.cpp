#include "modules/bus/sequence_gaps.h"

#include <catch2/catch.hpp>

namespace palpate::bus {
namespace {

WriterId writer(std::size_t name) {
  WriterId id{};
  id[0] = static_cast<unsigned char>(name);
  id[1] = static_cast<unsigned char>(name >> 8);
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
  // Oracle: each of three times as many writers as can be known at a time leaves a gap of one.
  constexpr std::size_t kWriters = 3 * SequenceGaps::kMostWriters;
  SequenceGaps gaps;
  for (std::size_t name = 0; name < kWriters; ++name) {
    gaps.count(writer(name), 1);
    gaps.count(writer(name), 3);
  }
  CHECK(gaps.dropped() == kWriters);
}

TEST_CASE("sequence gaps: as many writers in turn as a topic has keys are all known", "[bus]") {
  // Oracle: each of 256 organs' writers loses one sample of three. Of 32 in turn none was known
  // any more when it came again.
  SequenceGaps gaps;
  for (const std::uint64_t sequence : {1, 3}) {
    for (std::size_t name = 0; name < kMaxKeys; ++name) gaps.count(writer(name), sequence);
  }
  CHECK(gaps.dropped() == kMaxKeys);
}

TEST_CASE("sequence gaps: of too many writers those that have ended are forgotten", "[bus]") {
  // Oracle: counts by hand. Of as many as can be known the newest two end; two come in their place.
  SequenceGaps gaps;
  constexpr std::size_t kMost = SequenceGaps::kMostWriters;
  const auto name_of = [](std::size_t k) { return k < kMost - 2 ? k : k + 2; };
  for (std::size_t name = 0; name < kMost; ++name) gaps.count(writer(name), 1);
  for (const std::uint64_t sequence : {2, 4}) {  // 3
    for (std::size_t k = 0; k < kMost; ++k) gaps.count(writer(name_of(k)), sequence);
  }
  CHECK(gaps.dropped() == kMost);
}

}  // namespace palpate::bus
