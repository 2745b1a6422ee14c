#include "palpate/run_snapshot.h"

#include <catch2/catch.hpp>
#include <csignal>
#include <sstream>

#include "modules/core/error.h"
#include "modules/recording/diff.h"
#include "modules/recording/inspect.h"
#include "modules/scene/scene_file.h"
#include "palpate/run_command.h"
#include "tests/palpate/ball_scene.h"
#include "tests/palpate/typed_command.h"
#include "tests/scratch_folder.h"
#include "tests/system/launched.h"

using namespace palpate;
using namespace palpate::launcher;
using Catch::Contains;

namespace {

constexpr const char* kPress =
    "scripted: {start_m: [0, 0, 0.065], moves: [{to_m: [0.01, 0, 0.045], duration_s: 0.3}]}";

std::string said_by(const RunOptions& options) {
  std::ostringstream out, log;
  REQUIRE(run_command(options, out, log) == kExitDone);
  return log.str();
}

}  // namespace

TEST_CASE("run snapshot: a run that goes on is compared with a whole one where it begins") {
  // Oracle: a session that was never interrupted; its mesh follows the touch, so that surfaces said
  // before are not there.
  const ScratchFolder folder;
  RunOptions run;
  run.scene = scene::scene_file("liver_touch");
  run.in_process = true;
  run.duration = 6.2;
  run.record = folder / "whole.mcap";
  run.snapshot_at = 6;
  run.snapshot = folder / "at.snapshot";
  CHECK_THAT(said_by(run), Contains("at.snapshot of 6 s\n"));
  run.record = folder / "rest.mcap";
  run.from_snapshot = run.snapshot;
  run.snapshot_at.reset();
  run.snapshot.clear();
  said_by(run);
  const auto both = recording::compare({folder / "whole.mcap", folder / "rest.mcap"});
  CHECK(both.equal());
  CHECK(both.from_ns == 6'000'000'000);
  CHECK(both.topics.at("haptic_force").compared == 200);
  CHECK(both.topics.at("surface").compared > 1);
  for (const auto& topic : recording::summarize(folder / "rest.mcap").topics) {
    CHECK(topic.missing == 0);
  }
  CHECK_FALSE(recording::compare({folder / "rest.mcap", folder / "rest.mcap"}).from_ns);
}

TEST_CASE(
    "run snapshot: which time it is of is said, where no cycle begins at what was asked for") {
  // Oracle: the grid of the haptic loop, 1 ms.
  const testing::BallScene scene(kPress);
  RunOptions run;
  run.scene = scene.file();
  run.in_process = true;
  run.duration = 0.1;
  run.snapshot_at = 0.0502;
  run.snapshot = scene.folder() / "at.snapshot";
  CHECK_THAT(said_by(run), Contains("of 0.051 s, where the first cycle from 0.0502 s on begins"));

  // Who goes on from there with the time that the run ended at has asked for nothing.
  run.from_snapshot = run.snapshot;
  run.duration = 0.05;
  run.snapshot_at.reset();
  run.snapshot.clear();
  std::ostringstream out, log;
  CHECK_THROWS_WITH(run_command(run, out, log), run.from_snapshot.string() +
                                                    ": is of 0.051 s, and the run ends at 0.05 s: "
                                                    "give a --duration beyond 0.051");
}

TEST_CASE("run snapshot: a run that is stopped before it says that there is none, and fails") {
  // Oracle: the message, the exit code that --help states, and the folder, in which no part is
  // left.
  const testing::BallScene scene(kPress);
  const std::string snapshot = (scene.folder() / "at.snapshot").string();
  for (const std::string driver : {"--in-process", "--lockstep"}) {
    testing::Launched run(
        scene, {driver, "--duration", "100000", "--snapshot-at", "99999", "--snapshot", snapshot});
    CHECK(run.wait_for_text("times real time"));
    run.child().signal(SIGINT);
    CHECK(run.wait_for_end() == kExitFailed);
    CHECK_THAT(run.said(), Contains("there is no snapshot " + snapshot + ": the run ended at "));
    for (const auto& entry : std::filesystem::directory_iterator(scene.folder())) {
      CHECK_THAT(entry.path().filename().string(), !Contains("snapshot"));
    }
  }
  CHECK_THAT(testing::type("palpate", {"run", "--help"}).said,
             Contains("or it was stopped before its snapshot"));
}
