#include "modules/core/sort_unique.h"

#include <catch2/catch.hpp>
#include <random>
#include <set>

namespace palpate {

TEST_CASE("sort unique: pairs by buckets are those of a set, in its order") {
  // Oracle: std::set; also for lists without pairs, and from a sorter used before.
  std::mt19937 random(1);
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  PairSorter<Pair> sorter;
  for (const std::uint32_t count : {0U, 1U, 7U, 300U}) {
    for (const std::size_t length : {0, 1, 50, 2000}) {
      std::vector<Pair> pairs(count == 0 ? 0 : length);
      for (auto& [first, second] : pairs) first = random() % count, second = random() % 40;
      const std::set<Pair> expected(pairs.begin(), pairs.end());
      sorter.sort_unique(pairs, count);
      CHECK(pairs == std::vector<Pair>(expected.begin(), expected.end()));
    }
  }
}

TEST_CASE("sort unique: edges of few nodes, and of numbers far apart, are those of a set") {
  // Oracle: std::set.
  using Edge = std::array<std::uint32_t, 2>;
  std::mt19937 random(2);
  for (const std::uint32_t largest : {0U, 5U, 1000U, 4'000'000'000U}) {
    for (const std::size_t length : {0, 1, 300, 20'000}) {
      std::vector<Edge> edges(length);
      for (Edge& edge : edges) {
        for (std::uint32_t& node : edge) node = largest == 0 ? 0 : random() % largest;
      }
      const std::set<Edge> expected(edges.begin(), edges.end());
      sort_unique(edges);
      CHECK(edges == std::vector<Edge>(expected.begin(), expected.end()));
    }
  }
}

}  // namespace palpate
