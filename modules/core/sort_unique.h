// Lists as ordered sets.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace palpate {

/// Ascending, each item once.
template <class T>
void sort_unique(std::vector<T>& items) {
  std::sort(items.begin(), items.end());
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

/// sort_unique() of many pairs that share few first members: each of those gets a bucket, so that
/// only short lists are sorted.
/// @tparam Pair  std::pair or std::array of two std::uint32_t
template <class Pair>
class PairSorter {
 public:
  /// @param count  first members are below this
  void sort_unique(std::vector<Pair>& pairs, std::size_t count) {
    ends_.assign(count, 0);
    for (const auto& [first_member, second] : pairs) ++ends_[first_member];
    std::uint32_t sum = 0;
    for (std::uint32_t& end : ends_) end = std::exchange(sum, sum + end);
    seconds_.resize(pairs.size());
    for (const auto& [first_member, second] : pairs) seconds_[ends_[first_member]++] = second;
    pairs.clear();
    auto first = seconds_.begin();
    for (std::uint32_t k = 0; k < count; ++k) {
      const auto last = seconds_.begin() + ends_[k];
      std::sort(first, last);
      for (const auto end = std::unique(first, last); first != end; ++first) {
        pairs.push_back({k, *first});
      }
      first = last;
    }
  }

 private:
  std::vector<std::uint32_t> ends_;     ///< of each bucket, in seconds_
  std::vector<std::uint32_t> seconds_;  ///< by first member
};

/// Edges of a mesh: first members are numbers of nodes. Where those are so far apart that there
/// would be more than four buckets for each edge, all are sorted at once.
inline void sort_unique(std::vector<std::array<std::uint32_t, 2>>& edges) {
  std::uint32_t last = 0;
  for (const auto& edge : edges) last = std::max(last, edge[0]);
  if (last / 4 > edges.size()) return sort_unique<std::array<std::uint32_t, 2>>(edges);
  PairSorter<std::array<std::uint32_t, 2>>().sort_unique(edges, std::size_t{last} + 1);
}

}  // namespace palpate
