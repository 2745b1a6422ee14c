#include "collision/index_marks.h"

#include <catch2/catch.hpp>

namespace palpate::collision {

TEST_CASE("index marks: begin forgets all, whatever the number of indices was before") {
  // Oracle: definition.
  IndexMarks marks;
  marks.begin(3);
  CHECK(marks.at(2) == IndexMarks::kNone);
  marks.set(2, 7);
  marks.set(0, 0);
  CHECK(marks.at(2) == 7);
  CHECK(marks.at(0) == 0);
  CHECK(marks.at(1) == IndexMarks::kNone);
  marks.begin(10);
  for (std::uint32_t i = 0; i < 10; ++i) CHECK(marks.at(i) == IndexMarks::kNone);
}

}  // namespace palpate::collision
