#include "studies/report/progress.h"

#include <catch2/catch.hpp>
#include <sstream>

namespace palpate::report {
namespace {

TEST_CASE("progress: says what begins, and ends the job when asked to") {
  // Oracle: the log, and the exception.
  std::ostringstream log;
  bool stop = false;
  Progress progress(log, [&] { return stop; });
  progress.begin("counting");
  CHECK(log.str() == "counting\n");
  CHECK_NOTHROW(progress.at(1, 2, "sheep"));
  stop = true;
  CHECK_THROWS_AS(progress.at(2, 2, "sheep"), Stopped);
}

}  // namespace
}  // namespace palpate::report
