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
