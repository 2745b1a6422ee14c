#include "studies/fuzz/tally.h"

#include <catch2/catch.hpp>
#include <sstream>

namespace palpate::fuzz {
namespace {

TEST_CASE("tally: counts scenes, and what became of them without guards") {
  // Oracle: counting by hand. Messages refused are no guard of the state.
  Tally tally;
  Outcome replaced, shortened, failed, refused;
  replaced.guards[std::size_t(Guard::kEnergyGrew)] = 3;
  replaced.unguarded = Unguarded::kFine;
  shortened.guards[std::size_t(Guard::kStepReduced)] = 1;
  shortened.guards[std::size_t(Guard::kMessageRefused)] = 1;
  shortened.unguarded = Unguarded::kFailed;
  failed.ending = Ending::kFailed;
  failed.what = "node too fast: 3 m";
  refused.guards[std::size_t(Guard::kMessageRefused)] = 1;
  CHECK_FALSE(refused.any_guard_of_state());
  CHECK(shortened.any_guard_of_state());
  for (const Outcome& outcome : {replaced, shortened, failed, refused}) tally.add(7, outcome);
  std::ostringstream out;
  tally.print(out);
  CHECK(tally.failed() == 1);
  CHECK_THAT(out.str(),
             Catch::Contains("4 scenes: 3 ran, 0 refused with a message, 1 failed unguarded") &&
                 Catch::Contains("energy_grew       1, of which 1 end well") &&
                 Catch::Contains("1 of 2 scenes in which a guard acted on an organ, 1 of 1 in") &&
                 Catch::Contains("FAILED node too fast: 1 scenes, k = 7"));
}

}  // namespace
}  // namespace palpate::fuzz
