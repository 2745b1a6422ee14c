#include "collision/index_marks.h"

#include <catch2/catch.hpp>
#include <map>
#include <random>

namespace palpate::collision {

TEST_CASE("index marks: begin forgets all") {
  // Oracle: definition.
  IndexMarks marks;
  marks.begin();
  CHECK(marks.at(2) == IndexMarks::kNone);
  marks.set(2, 7);
  marks.set(0, 0);
  CHECK(marks.at(2) == 7);
  CHECK(marks.at(0) == 0);
  CHECK(marks.at(1) == IndexMarks::kNone);
  marks.begin();
  for (std::uint32_t i = 0; i < 10; ++i) CHECK(marks.at(i) == IndexMarks::kNone);
}

TEST_CASE("index marks: one that is there is not added, whatever else shares its low half") {
  // Oracle: std::map.
  IndexMarks marks;
  std::mt19937_64 random(5);
  for (int walk = 0; walk < 5; ++walk) {
    marks.begin();
    std::map<std::uint64_t, std::uint32_t> there;
    for (std::uint32_t k = 0; k < 2000; ++k) {
      const std::uint64_t index = (random() % 40) << 32 | random() % 40;
      const auto [first, is_new] = there.try_emplace(index, k);
      const std::uint32_t had = marks.add(index, k);
      if (had != (is_new ? IndexMarks::kNone : first->second)) {
        FAIL_CHECK(index << " is added twice, or never, or has another value");
      }
    }
    CHECK(there.size() > 1000);
  }
}

TEST_CASE("index marks: thousands of them, near and far, again and again") {
  // Oracle: std::map.
  IndexMarks marks;
  std::mt19937 random(3);
  for (int walk = 0; walk < 20; ++walk) {
    marks.begin();
    std::map<std::uint32_t, std::uint32_t> expected;
    const std::uint32_t most = walk % 2 == 0 ? 3000 : 0xffffffff;
    for (std::uint32_t k = 0; k < 2000; ++k) {
      const std::uint32_t index = random() % most;
      marks.set(index, k);
      expected[index] = k;
      const std::uint32_t other = random() % most;
      CHECK(marks.at(other) == (expected.contains(other) ? expected[other] : IndexMarks::kNone));
    }
    for (const auto& [index, value] : expected) CHECK(marks.at(index) == value);
  }
}

}  // namespace palpate::collision
