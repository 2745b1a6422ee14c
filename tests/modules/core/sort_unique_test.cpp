#include "modules/core/sort_unique.h"

#include <catch2/catch.hpp>
#include <random>
#include <set>

namespace palpate {

TEST_CASE("sort unique: pairs by buckets are those of a set, in its order") {
  // Oracle: std::set; also for lists without pairs, and from a sorter used before.
  std::mt19937 random(1);
  PairSorter sorter;
  for (const std::uint32_t count : {0U, 1U, 7U, 300U}) {
    for (const std::size_t length : {0, 1, 50, 2000}) {
      std::vector<PairSorter::Pair> pairs(count == 0 ? 0 : length);
      for (auto& [first, second] : pairs) first = random() % count, second = random() % 40;
      const std::set<PairSorter::Pair> expected(pairs.begin(), pairs.end());
      sorter.sort_unique(pairs, count);
      CHECK(pairs == std::vector<PairSorter::Pair>(expected.begin(), expected.end()));
    }
  }
}

}  // namespace palpate
