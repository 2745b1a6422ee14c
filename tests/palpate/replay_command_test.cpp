#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "modules/recording/recorder.h"
#include "palpate/replay_command.h"
#include "tests/palpate/ball_scene.h"

#include <sstream>

using namespace palpate;
using namespace palpate::launcher;
using Catch::Contains;

TEST_CASE("replay: a recording without a scene or motion is refused by name") {
  // Oracle: the messages.
  const palpate::testing::BallScene scene;
  const auto file = scene.folder() / "empty.mcap";
  recording::McapWriter(file).close();
  std::ostringstream out, log;
  RunOptions run;
  CHECK_THROWS_WITH(replay_command(file, {}, run, out, log),
                    Contains(file.string()) && Contains("holds no scene"));
  run.scene = scene.file();
  CHECK_THROWS_AS(replay_command(file, {}, run, out, log), InputError);
  for (const Playing& playing : {Playing{1, 1, false}, {0, 2, false}, {0, 1, true}}) {
    CHECK_THROWS_WITH(replay_command(file, playing, run, out, log),
                      Contains("of a replay without SCENE"));
  }
}

TEST_CASE("replay: options that a recording alone, or a rerun, would pass over are refused") {
  // Oracle: what each is for; without SCENE no module is started, a rerun is of one process.
  RunOptions run;
  Playing shown, rerun;
  rerun.rerun = {"haptics"};
  const std::vector<std::string> both_refuse{"--lockstep",      "--snapshot-at", "--snapshot",
                                             "--from-snapshot", "--only",        "--hosts",
                                             "--host",          "--no-restart",  "--summary"};
  for (const std::string& option : both_refuse) {
    INFO(option);
    CHECK_THROWS_WITH(
        check_replay_options({option}, shown, run),
        option + ": of a replay with SCENE; without, the recording is shown as it was");
    CHECK_THROWS_WITH(check_replay_options({option}, rerun, run),
                      option + ": does not go together with --rerun");
  }
  for (const char* option : {"--record", "--overwrite", "--duration", "--set", "--record-topics"}) {
    CHECK_THROWS_AS(check_replay_options({option}, shown, run), InputError);
    CHECK_NOTHROW(check_replay_options({option}, rerun, run));
  }
  for (const char* option :
       {"--frames", "--secure", "--session", "--rate", "--start", "--step", "--headless"}) {
    CHECK_THROWS_AS(check_replay_options({option}, rerun, run), InputError);
    CHECK_NOTHROW(check_replay_options({option}, shown, run));
  }
  // It is of one process anyway.
  CHECK_THROWS_AS(check_replay_options({"--in-process"}, rerun, run), InputError);
  run.scene = "a.yaml";
  CHECK_NOTHROW(check_replay_options({"--summary", "--only", "--lockstep"}, shown, run));
}
