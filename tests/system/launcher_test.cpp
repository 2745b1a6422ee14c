// `palpate run` as a person uses it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <sstream>
#include <thread>

#include "modules/recording/inspect.h"
#include "modules/recording/sample_reader.h"
#include "tests/file_size_limit.h"
#include "tests/scratch_folder.h"
#include "tests/system/launched.h"

using namespace palpate;
using namespace palpate::testing;
using Catch::Contains;

namespace {

std::set<std::string> shared_memory_files() {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
    const std::string name = entry.path().filename();
    if (name.find("fast") != std::string::npos) names.insert(name);
  }
  return names;
}

}  // namespace

TEST_CASE("launcher: runs for its duration, reports each second, sums up and records") {
  // Oracle: what it says and writes: all of its duration was simulated, or it says that it could
  // not keep up.
  const BallScene scene(
      "scripted: {start_m: [0, 0, 0.07], moves: [{to_m: [0, 0, 0.05], duration_s: 1}]}");
  const auto summary = scene.folder() / "summary.txt";
  const auto recording = scene.folder() / "run.mcap";
  Launched run(
      scene, {"--duration", "2.2", "--summary", summary.string(), "--record", recording.string()});
  CHECK(run.wait_for_end() == 0);
  INFO(run.said());
  CHECK_THAT(run.said(),
             Contains(" s  real time") && Contains("V/V* ball 1.0000") && Contains(" (of 1000 Hz"));
  const auto from = [&run](const char* words) {
    return run.said().substr(std::min(run.said().find(words), run.said().size()));
  };
  double rate = 0;  // a host's pause takes some of the 1000, and what it missed is beside it
  REQUIRE(std::sscanf(from("haptics ").c_str(), "haptics %lf Hz", &rate) == 1);
  CHECK((rate == 1000 || from("haptics ").find(" missed)") != std::string::npos));
  CHECK(rate > 500);
  CHECK(rate < 1100);
  CHECK_THAT(run.said(), Contains("scene press: 2.2 s") || Contains("slower than real time"));
  double simulated = 0, wall = 0;
  REQUIRE(std::sscanf(from("scene press: ").c_str(), "scene press: %lf s simulated in %lf s",
                      &simulated, &wall) == 2);
  CHECK(simulated <= 2.2);
  CHECK(simulated > 1.1);
  CHECK(wall >= 2.2);
  std::stringstream text;
  text << std::ifstream(summary).rdbuf();
  CHECK_THAT(text.str(), Contains("% on time") && Contains("organ ball") &&
                             Contains("probe finger") && Contains("real-time factor"));
  CHECK_THAT(text.str(), !Contains("force at most 0.000 N"));
  // Another span than the summary's, and so another figure.
  CHECK_THAT(run.said(), Contains("Hz since its start, waiting for the session too: "));
  CHECK(std::filesystem::file_size(recording) > 100'000);
  CHECK(run.processes().empty());
}

TEST_CASE("launcher: Ctrl-C leaves no process and nothing in shared memory") {
  // Oracle: the process table and /dev/shm.
  const auto before = shared_memory_files();
  const BallScene scene;
  Launched run(scene, {});
  REQUIRE(run.wait_for_text(" s  real time"));
  REQUIRE(run.processes().size() == 4);
  run.child().signal(SIGINT);
  CHECK(run.wait_for_end() == 0);
  CHECK(run.processes().empty());
  CHECK(shared_memory_files() == before);
}

TEST_CASE("launcher: a second one of the same session is refused by name and disturbs nothing") {
  // Oracle: its exit code and words; the first goes on to its end.
  const BallScene scene;
  const bus::BusOptions options = own_bus_options();
  Launched first(scene, {"--duration", "2"}, options);
  REQUIRE(first.wait_for_text(" s  real time"));
  Launched second(scene, {"--duration", "2"}, options);
  CHECK(second.wait_for_end() == 2);
  CHECK_THAT(second.said(), Contains("session '" + options.session + "' already runs here"));
  CHECK(first.wait_for_end() == 0);
  CHECK_THAT(first.said(), Contains("scene press: 2.0 s simulated in 2.0 s"));
}

TEST_CASE("launcher: a launcher that is killed leaves no process") {
  // Oracle: the process table.
  const BallScene scene;
  Launched run(scene, {});
  REQUIRE(run.wait_for_text(" s  real time"));
  run.child().signal(SIGKILL);
  CHECK(wait_until([&] { return run.processes().empty(); }));
}

TEST_CASE("launcher: a hanging module does not outlive a launcher that is killed") {
  // Oracle: the process table. A stopped process hears no SIGTERM.
  const BallScene scene;
  Launched run(scene, {});
  REQUIRE(run.wait_for_text(" s  real time"));
  kill(run.processes().at("palpate-collision"), SIGSTOP);
  run.child().signal(SIGKILL);
  CHECK(wait_until([&] { return run.processes().empty(); }));
}

TEST_CASE("launcher: a module that does not end when told is killed, and named") {
  // Oracle: what it says, the process table. A stopped process hears no SIGTERM.
  const BallScene scene;
  Launched run(scene, {});
  REQUIRE(run.wait_for_text(" s  real time"));
  kill(run.processes().at("palpate-haptics"), SIGSTOP);
  run.child().signal(SIGTERM);
  CHECK(run.wait_for_end() == 0);
  CHECK_THAT(run.said(), Contains("palpate: haptics did not end when told, and was killed"));
  CHECK(run.processes().empty());
}

TEST_CASE("launcher: modules that die or hang are started again, and counted") {
  // Oracle: the process table, the summary; the exit code of a session that went on to its end.
  const BallScene scene(
      "scripted: {start_m: [0, 0, 0.07], moves: [{to_m: [0, 0, 0.055], duration_s: 1}]}");
  Launched run(scene, {"--duration", "14", "--record", (scene.folder() / "r.mcap").string()});
  REQUIRE(run.wait_for_text("2.0 s  real time"));
  for (const char* module : {"palpate-haptics", "palpate-collision", "palpate-recorder"}) {
    const pid_t before = run.processes().at(module);
    kill(before, SIGKILL);
    INFO(module);
    CHECK(wait_until([&] {
      const auto now = run.processes();
      return now.count(module) == 1 && now.at(module) != before;
    }));
  }
  const pid_t stopped = run.processes().at("palpate-deformation");
  kill(stopped, SIGSTOP);
  REQUIRE(run.wait_for_text("palpate: deformation ended: said nothing for 3 s, was killed"));
  REQUIRE(run.wait_for_text("palpate: deformation is started again"));
  CHECK(run.wait_for_text("[deformation] info: goes on from what its predecessor remembered"));
  CHECK(run.wait_for_end() == 0);
  INFO(run.said());
  for (const char* module : {"haptics", "collision", "recorder", "deformation"}) {
    CHECK_THAT(run.said(), Contains(std::string("started again: ") + module + ", once"));
  }
  CHECK_THAT(run.said(), !Contains("FAILED"));
  CHECK(std::filesystem::file_size(scene.folder() / "r.mcap") > 0);
  CHECK(std::filesystem::file_size(scene.folder() / "r.part2.mcap") > 0);
}

TEST_CASE("launcher: a module that dies is named, the rest goes on, it can be started again") {
  // Oracle: what it says; the exit code tells of the failure.
  const BallScene scene;
  Launched run(scene, {"--no-restart"});
  REQUIRE(run.wait_for_text(" s  real time"));
  kill(run.processes().at("palpate-collision"), SIGKILL);
  REQUIRE(run.wait_for_text("palpate: collision ended: killed by signal 9 (Killed)"));
  REQUIRE(run.wait_for_text("the rest goes on; to start it again: "));
  // as a person would, with the line that was printed
  const auto begin = run.said().find("to start it again: ") + 19;
  std::istringstream words(run.said().substr(begin, run.said().find('\n', begin) - begin));
  std::vector<std::string> command;
  for (std::string word; words >> word;) command.push_back(word);
  launcher::ChildProcess again(command[0], {command.begin() + 1, command.end()});
  CHECK(wait_until([&] { return run.processes().count("palpate-collision") == 1; }));
  REQUIRE(run.wait_for_text("3.0 s  real time"));
  CHECK(run.processes().size() == 4);
  run.child().signal(SIGTERM);
  CHECK(run.wait_for_end() == 1);
  CHECK_THAT(run.said(), Contains("FAILED: collision: killed by signal 9 (Killed)"));
  CHECK(wait_until([&] { return again.ended().has_value(); }));  // the session's stop reaches it
}

TEST_CASE(
    "launcher: a recording on a full disk ends whole, the rest goes on, and part 2 is offered") {
  // Oracle: the recording itself, read again, and what was said; exit code 0.
  const BallScene scene;
  const auto recording = scene.folder() / "r.mcap";
  const FileSizeLimit full(400'000);  // a second's, as `ulimit -f` sets it for all of a session
  Launched run(scene, {"--record", recording.string()});
  REQUIRE(run.wait_for_text("palpate: recorder ended: exit code 0; it said: [recorder] " +
                            recording.string() + ": cannot write: File too large"));
  REQUIRE(run.wait_for_text("the rest goes on; free space first, then part 2 is recorded by: "));
  CHECK(run.processes().count("palpate-recorder") == 0);
  const auto said = run.said().size();
  CHECK(
      wait_until([&] { return run.listened().find(" s  real time", said) != std::string::npos; }));
  run.child().signal(SIGTERM);
  CHECK(run.wait_for_end() == 0);
  CHECK_THAT(run.said(), Contains("palpate-recorder " + (scene.folder() / "r.part2.mcap").string() +
                                  " --session"));
  CHECK_THAT(run.said(), !Contains("to start it again") && Contains("recording: ended "));
  const recording::RecordingSummary read = recording::summarize(recording);
  CHECK_FALSE(read.torn);
  CHECK(read.topics.size() >= 8);
  for (const auto& topic : read.topics) CHECK((topic.thinned || topic.missing == 0));
  CHECK_FALSE(std::filesystem::exists(scene.folder() / "r.part2.mcap"));
}

TEST_CASE("launcher: a disk without room for a recording is told by summary and exit code") {
  // Oracle: the summary, the exit code, and the folder: no empty file that would refuse the next
  // try.
  const BallScene scene;
  const auto recording = scene.folder() / "r.mcap";
  const FileSizeLimit full(300);  // less than the session's metadata take
  Launched run(scene, {"--record", recording.string(), "--duration", "2"});
  CHECK(run.wait_for_end() == 1);
  CHECK_THAT(run.said(), Contains(": cannot write: File too large"));
  for (const auto& entry : std::filesystem::directory_iterator(scene.folder())) {
    CHECK(entry.path().extension() != ".mcap");
  }
}

TEST_CASE("launcher: a session begins when its recorder hears it, however late that is") {
  // Oracle: no second of the session while its recorder is stopped, for less than makes it hang;
  // the recording: the scene, and a pose of the session's first 10 ms.
  const BallScene scene;
  const auto recording = scene.folder() / "r.mcap";
  Launched run(scene, {"--record", recording.string(), "--duration", "1"});
  REQUIRE(wait_until([&] { return run.processes().count("palpate-recorder") == 1; }));
  const pid_t recorder = run.processes().at("palpate-recorder");
  kill(recorder, SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  CHECK_THAT(run.listened(), !Contains(" s  real time"));
  kill(recorder, SIGCONT);
  CHECK(run.wait_for_end() == 0);
  CHECK_THAT(run.said(), !Contains("recording: "));
  recording::SampleReader reader(recording);
  bool has_scene = false, has_beginning = false;
  while (const auto sample = reader.next()) {
    has_scene |= sample->topic->name == bus::kScene.name;
    has_beginning |= sample->topic->name == bus::kProbeState.name &&
                     messages::header_of(sample->payload).sim_time_ns < 10'000'000;
  }
  CHECK(has_scene);
  CHECK(has_beginning);
}

TEST_CASE("launcher: a second one with --only joins the session and leaves it running") {
  // Oracle: what both say; the process table. The scene's duration is the first one's to keep.
  const BallScene scene("mouse: {start_m: [0, 0, 0.09]}", "duration_s: 1\n");
  Launched first(scene, {"--only", "deformation,haptics", "--duration", "100"});
  REQUIRE(first.wait_for_text(" s  real time"));
  Launched second(scene, {"--only", "collision"}, first.options());
  const bool joined = second.wait_for_text("joining the session that already runs");
  INFO(first.said() << second.said());
  REQUIRE(joined);
  REQUIRE(second.processes().size() == 4);  // the two launchers share a name
  REQUIRE(first.wait_for_text("2.0 s  real time"));
  REQUIRE(second.wait_for_text(" s  real time"));
  CHECK_FALSE(second.child().ended().has_value());
  second.child().signal(SIGINT);
  CHECK(second.wait_for_end() == 0);
  REQUIRE(first.wait_for_text("3.0 s  real time"));
  CHECK(first.processes().size() == 3);
  // Its duration counts from when it joined: the session's time is beyond it.
  Launched third(scene, {"--only", "collision", "--duration", "1"}, first.options());
  REQUIRE(third.wait_for_text("joining the session that already runs"));
  const auto joined_at = std::chrono::steady_clock::now();
  CHECK(third.wait_for_end() == 0);
  CHECK(std::chrono::steady_clock::now() - joined_at > std::chrono::milliseconds(700));
  first.child().signal(SIGINT);
  CHECK(first.wait_for_end() == 0);
}

TEST_CASE("launcher: who would join with another scene is refused, and the session goes on") {
  // Oracle: exit codes, and the first one's session time, which goes on.
  const BallScene scene, other("topic: {start_m: [0, 0, 0.08]}");
  Launched first(scene, {"--only", "deformation,haptics"});
  REQUIRE(first.wait_for_text(" s  real time"));
  Launched second(other, {"--only", "collision"}, first.options());
  CHECK(second.wait_for_end() == 2);
  CHECK_THAT(second.said(), Contains("the session plays scene"));
  REQUIRE(first.wait_for_text("4.0 s  real time"));
  first.child().signal(SIGINT);
  CHECK(first.wait_for_end() == 0);
}

TEST_CASE("launcher: a module that refuses its input ends the start with exit code 2") {
  // Oracle: the exit codes. Who joins a session looks at nothing before; of the modules only
  // haptics reads the recording that the scene names.
  BallScene scene("topic: {}");
  std::ofstream(scene.folder() / "motion.csv") << "t, x, y, z\n0, 0, 0, 1\n";
  scene.set_device("trajectory: {file: motion.csv}");
  Launched run(scene, {"--only", "haptics"});
  CHECK(run.wait_for_end() == 2);
  CHECK_THAT(run.said(), Contains("palpate: haptics ended: exit code 2") && Contains("motion.csv"));
  CHECK(run.processes().empty());
}

TEST_CASE("launcher: stopped while Gmsh fills an organ, it says so and no error") {
  // Oracle: exit code 0, and the words; a Gmsh that never ends.
  const ScratchFolder folder;
  const auto gmsh = folder.write("gmsh", "#!/bin/sh\necho > \"$0.began\"\nexec sleep 100\n");
  std::filesystem::permissions(gmsh, std::filesystem::perms::owner_all);
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", (gmsh.parent_path().string() + ":" + path).c_str(), 1);
  Running run(bin("palpate"), joined({"run", "liver_solid", "--headless"}, own_bus_options()));
  CHECK(wait_until([&] { return std::filesystem::exists(folder / "gmsh.began"); }));
  run.child().signal(SIGTERM);
  CHECK(run.wait_for_end() == 0);
  ::setenv("PATH", path.c_str(), 1);
  CHECK_THAT(run.said(), Contains("[deformation] info: stopped while Gmsh made tetrahedra\n") &&
                             !Contains("error"));
}

TEST_CASE("launcher: a recording can be replayed as the input of a new run") {
  // Oracle: the finger of the second run presses as that of the first did.
  const BallScene scene(
      "scripted: {start_m: [0, 0, 0.07], moves: [{to_m: [0, 0, 0.05], duration_s: 1}]}");
  const auto recording = scene.folder() / "run.mcap";
  Launched first(scene, {"--duration", "1.5", "--record", recording.string()});
  REQUIRE(first.wait_for_end() == 0);
  const BallScene idle;  // its own device leaves the finger above the ball
  launcher::ChildProcess again(
      bin("palpate"), joined({"replay", recording.string(), idle.file().string(), "--headless",
                              "--duration", "1.5"},
                             own_bus_options()));
  std::string said;
  const auto listen = [&] {
    for (const auto& line : again.take_lines()) said += line + "\n";
  };
  REQUIRE(wait_until([&] {
    listen();
    return again.ended().has_value();
  }));
  listen();
  INFO(said);
  CHECK_THAT(said, Contains("probe finger") && !Contains("force at most 0.000 N"));
}
