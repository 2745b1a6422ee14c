// `palpate run` whose reaper, or whose reader, is gone.
#include <catch2/catch.hpp>

#include "tests/system/launched.h"

using namespace palpate;
using namespace palpate::testing;

namespace {

/// -1: it has none of that name.
pid_t child_named(const std::string& name, pid_t parent) {
  const std::string id = std::to_string(parent);
  std::ifstream children("/proc/" + id + "/task/" + id + "/children");
  for (pid_t child = -1; children >> child;) {
    std::string called;
    std::getline(std::ifstream("/proc/" + std::to_string(child) + "/comm"), called);
    if (called == name) return child;
  }
  return -1;
}

}  // namespace

TEST_CASE("launcher: goes on where its reaper is killed, and ends what hangs all the same") {
  // Oracle: the process table, the words, the exit code: a module that dies next is started again.
  const BallScene scene;
  Launched run(scene, {});
  REQUIRE(run.wait_for_text(" s  real time"));
  const pid_t reaper = child_named("palpate-reaper", run.child().process_id());
  REQUIRE(reaper > 0);
  kill(reaper, SIGKILL);
  kill(run.processes().at("palpate-haptics"), SIGKILL);
  CHECK(run.wait_for_text("palpate: haptics is started again"));
  CHECK(run.wait_for_text("ended: killed by signal 9 (Killed); it is started again"));
  kill(run.processes().at("palpate-collision"), SIGSTOP);
  run.child().signal(SIGKILL);
  CHECK(wait_until([&] { return run.processes().empty(); }));
}

TEST_CASE("launcher: a session outlives who reads its lines") {
  // Oracle: its exit code, and the summary that is written at its end. Both streams are a pipe
  // whose reader goes after the first line.
  const BallScene scene;
  const auto summary = scene.folder() / "s.txt", code = scene.folder() / "code";
  const auto words = joined({"run", scene.file().string(), "--headless", "--duration", "2.5",
                             "--summary", summary.string()},
                            own_bus_options());
  std::string line = bin("palpate").string();
  for (const auto& word : words) line += " " + word;
  Running shell("/bin/sh",
                {"-c", "{ " + line + " 2>&1; echo $? > " + code.string() + "; } | head -n 1"});
  CHECK(shell.wait_for_end() == 0);
  int ended_with = -1;
  std::ifstream(code) >> ended_with;
  CHECK(ended_with == 0);
  CHECK(std::filesystem::exists(summary));
}
