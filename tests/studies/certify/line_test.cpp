#include "studies/certify/line.h"

#include <catch2/catch.hpp>
#include <limits>

namespace palpate::certify {

TEST_CASE("certify line: it passes within its limit, and never with what is no number") {
  // Oracle: definition.
  const auto at = [](double value) { return Measured{"x", value, 2, "N", "a page", ""}; };
  CHECK(at_most("g", at(2)).verdict == Verdict::kPass);
  CHECK(at_most("g", at(2.1)).verdict == Verdict::kFail);
  CHECK(at_least("g", at(2)).verdict == Verdict::kPass);
  CHECK(at_least("g", at(1.9)).verdict == Verdict::kFail);
  for (const double value :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    CHECK(at_most("g", at(value)).verdict == Verdict::kFail);
    CHECK(at_least("g", at(value)).verdict == Verdict::kFail);
  }
  CHECK(text_of(at_least("g", at(1.9))) == "g: x: 1.9 N, at least 2 N: FAIL");
  Measured left = at(std::numeric_limits<double>::infinity());
  left.note = "it left after 0.3 s";
  CHECK(text_of(at_most("g", left)) == "g: x: inf N, at most 2 N: FAIL, it left after 0.3 s");
  CHECK(text_of(not_measured("g", "x", "no tip")) == "g: x: not measured, no tip");
  CHECK_FALSE(any_failed({at_most("g", at(2)), not_measured("g", "y", "")}));
  CHECK(any_failed({at_most("g", at(2)), at_most("g", at(3))}));
}

}  // namespace palpate::certify
