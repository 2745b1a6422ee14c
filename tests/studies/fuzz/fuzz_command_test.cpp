#include "studies/fuzz/fuzz_command.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "modules/core/error.h"
#include "tests/studies/chart/folders.h"

namespace palpate::fuzz {
namespace {

TEST_CASE("fuzz command: fifty random scenes run without an unguarded failure, and are kept") {
  // Oracle: invariants of everything published (lockstep.cpp); the second run reads what the first
  // left.
  const chart::testing::WorkFolder folder;
  FuzzOptions options;
  options.out = folder.path;
  options.scenes = 50;
  options.seed = 1;
  std::ostringstream out, again, log;
  CHECK(run_fuzz(options, out, log) == kExitDone);
  CHECK_THAT(out.str(), Catch::Contains("50 scenes") && Catch::Contains(" 0 failed unguarded"));
  INFO(log.str());
  run_fuzz(options, again, log);
  CHECK(again.str() == out.str());
}

}  // namespace
}  // namespace palpate::fuzz
