#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "modules/recording/player.h"
#include "modules/recording/recorder.h"
#include "palpate/replay_command.h"
#include "palpate/run_command.h"
#include "tests/modules/recording/payloads.h"
#include "tests/palpate/ball_scene.h"

#include <sstream>

using namespace palpate;
using namespace palpate::launcher;
using Catch::Contains;

namespace {

constexpr const char* kSinking =
    "scripted: {start_m: [0, 0, 0.09], moves: [{to_m: [0, 0, 0.08], duration_s: 0.1}]}";
constexpr const char* kRodAside =
    "  - name: rod\n    shape: {sphere: {radius_m: 0.01}}\n"
    "    device: {scripted: {start_m: [0.2, 0, 0.1], moves: [{to_m: [0.2, 0.05, 0.1], duration_s: "
    "0.1}]}}\n";

std::filesystem::path recording_of(const palpate::testing::BallScene& scene) {
  RunOptions run;
  run.scene = scene.file();
  run.in_process = true;
  run.duration = 0.2;
  run.record = scene.folder() / "run.mcap";
  std::ostringstream out, log;
  REQUIRE(run_command(run, out, log) == kExitDone);
  return run.record;
}

/// Anew in one process; what it logs.
std::string replayed(const std::filesystem::path& recording, RunOptions run) {
  run.in_process = true;
  run.overwrite = true;
  run.duration = 0.2;
  run.record = recording.parent_path() / "again.mcap";
  std::ostringstream out, log;
  REQUIRE(replay_command(recording, {}, run, out, log) == kExitDone);
  return log.str();
}

/// Last row of each probe's motion.
std::vector<std::string> last_places(const std::filesystem::path& recording) {
  std::vector<std::string> warnings, places;
  const auto folder = recording.parent_path() / "motion";
  for (const auto& probe : recording::extract_probe_trajectories(recording, folder, warnings)) {
    std::ifstream rows(probe.file);
    places.emplace_back();
    for (std::string row; std::getline(rows, row);) places.back() = row;
  }
  return places;
}

}  // namespace

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

TEST_CASE("replay: probes of a scene move as those of the same name moved") {
  // Oracle: the recorded places; the scene lists its probes the other way round.
  const palpate::testing::BallScene scene(kSinking, kRodAside);
  const auto recording = recording_of(scene);
  const auto then = last_places(recording);
  REQUIRE(then.size() == 2);
  RunOptions run;
  run.scene = scene.file();
  run.settings = {"probes[0].name=rod", "probes[1].name=finger"};
  CHECK_THAT(replayed(recording, run), !Contains("names"));
  CHECK(last_places(recording.parent_path() / "again.mcap") ==
        std::vector<std::string>{then[1], then[0]});
}

TEST_CASE("replay: a recording of one probe moves that one, though it is the scene's second") {
  // Oracle: the recorded place, and the other's own device.
  const palpate::testing::BallScene one(kSinking);
  const auto recording = recording_of(one);
  const palpate::testing::BallScene two(kSinking, kRodAside);
  RunOptions run;
  run.scene = two.file();
  run.settings = {"probes[0].name=rod", "probes[1].name=finger"};
  replayed(recording, run);
  const auto now = last_places(recording.parent_path() / "again.mcap");
  CHECK(now.at(1) == last_places(recording).at(0));
}

TEST_CASE("replay: a recorded probe that the scene has not is refused with all names") {
  // Oracle: the words.
  const palpate::testing::BallScene two(kSinking, kRodAside), one(kSinking);
  const auto recording = recording_of(two);
  std::ostringstream out, log;
  RunOptions run;
  run.scene = one.file();
  run.in_process = true;
  CHECK_THROWS_WITH(replay_command(recording, {}, run, out, log),
                    Contains("run.mcap: moves probe 'rod', which the scene has not: recorded were "
                             "'finger', 'rod', the scene has 'finger'; name the one") &&
                        Contains("--set probes[0].name=rod"));
}

TEST_CASE("replay: without a scene in the recording probes go by their order, and it says so") {
  // Oracle: the pose written by hand, and the words.
  const palpate::testing::BallScene scene(kSinking);
  RunOptions run;
  run.scene = scene.file();
  const auto moving = [&](std::uint32_t probe) {
    const auto name = scene.folder() / "nameless.mcap";
    recording::SampleFile file(name, {});
    for (const int ms : {0, 200}) {
      const auto state = recording::probe_state(1, ms * 1'000'000, probe, {0.1, 0, 0.25});
      file.add(recording::raw_sample(bus::kProbeState, state, ms));
    }
    file.close();
    return name;
  };
  CHECK_THAT(replayed(moving(0), run), Contains("no names of its probes") && Contains("'finger'"));
  CHECK_THAT(last_places(scene.folder() / "again.mcap").at(0), Contains(",0.1,0,0.25,"));
  std::ostringstream out, log;
  CHECK_THROWS_WITH(replay_command(moving(1), {}, run, out, log),
                    Contains("moves a probe number 1, of which it has no name; the scene has "
                             "'finger'"));
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
  run.frames = "pictures";  // which are replaced
  CHECK_NOTHROW(check_replay_options({"--frames", "--overwrite"}, shown, run));
  run.frames.clear();
  // It is of one process anyway.
  CHECK_THROWS_AS(check_replay_options({"--in-process"}, rerun, run), InputError);
  run.scene = "a.yaml";
  CHECK_NOTHROW(check_replay_options({"--summary", "--only", "--lockstep"}, shown, run));
}
