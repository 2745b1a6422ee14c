#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <sstream>

#include "modules/core/error.h"
#include "palpate/run_command.h"
#include "tests/system/launched.h"

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

TEST_CASE(
    "run: one that is stopped while an organ is resampled ends at once, and said what it did") {
  // Oracle: exit code 130, the words, the folder of temporary files; to its end it takes a minute.
  // With --set its launcher holds such a folder, in one process it waits for signals.
  const testing::BallScene scene;
  const auto temporary = scene.folder() / "tmp";
  std::filesystem::create_directory(temporary);
  for (const char* how : {"--headless", "--in-process"}) {
    CAPTURE(how);
    testing::Running run("/usr/bin/env",
                         {"TMPDIR=" + temporary.string(), testing::bin("palpate"), "run",
                          scene.file(), how, "--set", "organs[0].mesh.nodes=100000"});
    CHECK(run.wait_for_text("organ 'ball': resampling: "));
    run.child().signal(SIGTERM);
    CHECK(run.wait_for_end(10) == kExitStopped);
    CHECK_THAT(run.said(), Contains("palpate: stopped while a surface was resampled"));
    CHECK(std::filesystem::is_empty(temporary));
  }
}
