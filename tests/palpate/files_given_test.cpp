// Files as they are given to a command: what is no file is refused before it is opened, and what a
// command writes takes the place of nothing but its like.
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <thread>

#include "modules/core/error.h"
#include "tests/palpate/ball_scene.h"
#include "tests/palpate/typed_command.h"
#include "tests/scratch_folder.h"

using namespace palpate;
using palpate::testing::BallScene;
using palpate::testing::type;
using palpate::testing::wait_until;

namespace {

using Words = std::vector<std::string>;

/// A sound scene, its mesh, a recording of it and things that are no files.
struct GivenFiles {
  GivenFiles() {
    REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
    REQUIRE(
        type("palpate", {"run", scene, "--in-process", "--duration", "0.05", "--record", recording})
            .code == kExitDone);
  }
  BallScene ball;
  const std::string folder = ball.folder().string(), scene = ball.file().string(),
                    mesh = folder + "/ball.ply", fifo = folder + "/fifo",
                    recording = folder + "/a.mcap";
};

}  // namespace

TEST_CASE("files given: no option that reads one waits for a FIFO, or reads a device or a folder") {
  // Oracle: exit code 2 and the reason by hand. A FIFO that is opened would never be read.
  const GivenFiles given;
  for (const auto& [file, why] : std::vector<std::pair<std::string, std::string>>{
           {given.fifo, "is a FIFO, not a file"},
           {"/dev/zero", "is a device or socket, not a file"},
           {given.folder, "is a folder, not a file"}}) {
    for (const Words& typed :
         std::vector<Words>{{"run", file},
                            {"run", given.scene, "--hosts", file, "--host", "a"},
                            {"replay", file},
                            {"replay", given.recording, file},
                            {"inspect", file},
                            {"diff", given.recording, file},
                            {"diff", file, given.recording},
                            {"check", file},
                            {"new", file, "-o", given.folder + "/new.yaml"},
                            {"mesh", file},
                            {"mesh", given.mesh, "--near", file, "--radius-m", "0.01"},
                            {"plan", file},
                            {"certify", file, "--lockstep"}}) {
      const auto outcome = type("palpate", typed);
      CAPTURE(typed, outcome.said);
      CHECK(outcome.code == kExitBadInput);
      CHECK(outcome.said.find(file + ": " + why) != std::string::npos);
    }
  }
}

TEST_CASE("files given: nothing is written over what is something else, nor to a FIFO") {
  // Oracle: exit code 2, and the bytes of a scene.
  const GivenFiles given;
  const std::string before = text_in(given.mesh);
  for (const std::string& file : {given.mesh, given.fifo, std::string("/dev/null")}) {
    for (const Words& typed : std::vector<Words>{
             {"run", given.scene, "--in-process", "--duration", "0.05", "--summary", file},
             {"run", given.scene, "--in-process", "--duration", "0.05", "--record", file},
             {"inspect", given.recording, "--repair", file},
             {"inspect", given.recording, "--foxglove", file},
             {"inspect", given.recording, "--csv", file},
             {"diff", given.recording, given.recording, "--csv", file},
             {"new", given.mesh, "-o", file},
             {"keys", file},
             {"calibrate", "--quick", "--nodes", "162", "--csv", file},
             {"elements", "--quick", "-o", file},
             {"chart", "--quick", "-o", file}}) {
      const auto outcome = type("palpate", typed);
      CAPTURE(typed, outcome.said);
      CHECK(outcome.code == kExitBadInput);
    }
  }
  CHECK(text_in(given.mesh) == before);
}

TEST_CASE("files given: a summary replaces a summary") {
  // Oracle: the text's beginning and the one file.
  const GivenFiles given;
  const std::string file = given.folder + "/summary.txt";
  const Words run{"run", given.scene, "--in-process", "--duration", "0.05", "--summary", file};
  REQUIRE(type("palpate", run).code == kExitDone);
  std::filesystem::resize_file(file, 20);
  REQUIRE(type("palpate", run).code == kExitDone);
  CHECK(text_in(file).starts_with("scene "));
  CHECK(text_in(file).size() > 100);
}

TEST_CASE("files given: pictures without a visualizer are refused, not left out") {
  // Oracle: exit code 2 and both options' names.
  const GivenFiles given;
  const auto outcome =
      type("palpate", {"run", given.scene, "--no-visualizer", "--frames", given.folder});
  CHECK(outcome.code == kExitBadInput);
  CHECK(outcome.said.find("--frames excludes --no-visualizer") != std::string::npos);
}

TEST_CASE("files given: whatever ends the making of keys, the next try works") {
  // Oracle: the folder, with all keys or not there; the program's end at any time, by two signals.
  namespace fs = std::filesystem;
  const ScratchFolder folder;
  const auto keys = folder / "keys";
  const Words typed{"keys", keys.string()};
  const auto count = [](const fs::path& of) {
    return std::distance(fs::directory_iterator(of), {});
  };
  REQUIRE(type("palpate", typed).code == kExitDone);
  const auto all = count(keys);
  fs::remove_all(keys);
  for (const int signal : {SIGTERM, SIGKILL}) {
    for (int ms = 4; ms < 200; ms += 7) {
      launcher::ChildProcess making(fs::path(PALPATE_BIN_DIR) / "palpate", typed);
      std::this_thread::sleep_for(std::chrono::milliseconds(ms));
      making.signal(signal);
      REQUIRE(wait_until([&] { return making.ended().has_value(); }));
      CAPTURE(signal, ms);
      if (!fs::exists(keys)) continue;
      REQUIRE(count(keys) == all);
      fs::remove_all(keys);
    }
    CHECK((signal == SIGKILL || count(folder.path()) == 0));
    CHECK(type("palpate", typed).code == kExitDone);
    fs::remove_all(keys);
  }
}
