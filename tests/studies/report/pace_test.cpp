#include "studies/report/pace.h"

#include <catch2/catch.hpp>
#include <cmath>

namespace palpate::report {
namespace {

TEST_CASE("pace: time left is said in seconds, then minutes, and not before it is known") {
  // Oracle: by hand.
  CHECK(text_of_time_left(std::nan("")).empty());
  CHECK(text_of_time_left(39.2) == "; about 40 s left");
  CHECK(text_of_time_left(121) == "; about 3 min left");
  Pace pace;
  CHECK(std::isnan(pace.seconds_for(1)));
  pace.begin();
  pace.finish(2);
  CHECK(pace.seconds_for(4) == Approx(2 * pace.seconds_for(2)));
  CHECK(pace.seconds_for(0) == 0);
}

}  // namespace
}  // namespace palpate::report
