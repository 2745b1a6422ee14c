#include <catch2/catch.hpp>
#include <sstream>

#include "modules/core/error.h"
#include "palpate/run_command.h"
#include "tests/palpate/ball_scene.h"

using namespace palpate;
using namespace palpate::launcher;
using Catch::Contains;

TEST_CASE("in-process run: what its modules said while degraded is in the summary, once") {
  // Oracle: a probe that begins 3 cm deep in a ball; one that begins outside.
  const auto said = [](const char* start) {
    const testing::BallScene scene(start);
    RunOptions run;
    run.scene = scene.file();
    run.in_process = true;
    run.duration = 0.1;
    std::ostringstream out, log;
    REQUIRE(run_command(run, out, log) == kExitDone);
    return out.str();
  };
  const std::string told = "degraded for a while: collision: a probe was first heard of inside";
  const std::string inside = said("scripted: {start_m: [0, 0, 0.02], moves: [{wait_s: 1}]}");
  CHECK_THAT(inside, Contains(told));
  CHECK(inside.find(told) == inside.rfind(told));
  CHECK_THAT(said("scripted: {start_m: [0, 0, 0.2], moves: [{wait_s: 1}]}"), !Contains("degraded"));
}
