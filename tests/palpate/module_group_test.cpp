#include "palpate/module_group.h"

#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <sstream>

#include "modules/runtime/clock.h"
#include "tests/modules/runtime/own_bus.h"
#include "tests/palpate/shell_script.h"

using namespace palpate::launcher;
using palpate::testing::Scripts;
using palpate::testing::wait_until;

namespace {

/// What of a group ended until `count` have.
std::vector<ModuleEnd> wait_for_ends(ModuleGroup& group, std::size_t count) {
  std::vector<ModuleEnd> ends;
  wait_until([&] {
    for (auto& end : group.poll()) ends.push_back(end);
    return ends.size() >= count;
  });
  return ends;
}

}  // namespace

TEST_CASE("module group: an end comes with its reason, last error and how to start again") {
  // Oracle: what the script says.
  const Scripts scripts;
  const auto script =
      scripts.add("palpate-collision",
                  "echo '[collision] info: hello'; echo '[collision] error: no mesh'; "
                  "echo '[collision] info: bye'; exit 1");
  std::ostringstream log;
  ModuleGroup group({{"collision", script, {"a scene.yaml", "--session", "s"}}}, log);
  const auto ends = wait_for_ends(group, 1);
  REQUIRE(ends.size() == 1);
  CHECK(ends[0].module == "collision");
  CHECK(ends[0].failed);
  CHECK_FALSE(ends[0].bad_input);
  CHECK(ends[0].how == "exit code 1");
  CHECK(ends[0].last_error == "[collision] error: no mesh");
  CHECK(ends[0].start_again == script.string() + " 'a scene.yaml' --session s");
  CHECK(log.str() ==
        "[collision] info: hello\n[collision] error: no mesh\n[collision] info: bye\n");
  CHECK(group.poll().empty());  // told once
  CHECK(group.last_words()["collision"] == "[collision] info: bye");
  CHECK_FALSE(group.any_running());
}

TEST_CASE("module group: a recorder is not started again over what it recorded") {
  // Oracle: the command that is printed.
  const Scripts scripts;
  const auto script = scripts.add("palpate-recorder", "exit 1");
  std::ostringstream log;
  ModuleGroup group({{"recorder", script, {"run.mcap", "--session", "s"}, false}}, log);
  const auto ends = wait_for_ends(group, 1);
  REQUIRE(ends.size() == 1);
  CHECK(ends[0].start_again == script.string() + " run.part2.mcap --session s");
}

TEST_CASE("module group: how to start again names the keys, and the network, of the session") {
  // Oracle: by hand; without them the module would hear nobody.
  const Scripts scripts;
  const auto script = scripts.add("palpate-collision", "exit 1");
  std::ostringstream log;
  ::setenv("PALPATE_KEYS", "/a b/keys", 1);
  ::setenv("PALPATE_PEERS", "10.0.0.6", 1);
  ModuleGroup group({{"collision", script, {"--session", "s"}}}, log);
  const auto ends = wait_for_ends(group, 1);
  ::unsetenv("PALPATE_KEYS");
  ::unsetenv("PALPATE_PEERS");
  REQUIRE(ends.size() == 1);
  CHECK(ends[0].start_again ==
        "PALPATE_KEYS='/a b/keys' PALPATE_PEERS=10.0.0.6 " + script.string() + " --session s");
}

TEST_CASE("module group: what a module keeps outlives it, and no command names it") {
  // Oracle: the second process prints what the first wrote, and dies, too.
  const Scripts scripts;
  const auto script =
      scripts.add("palpate-deformation", "cat /proc/$$/fd/$4; echo kept > /proc/$$/fd/$4; exit 1");
  std::ostringstream log;
  ModuleCommand command{"deformation", script, {"--session", "s"}};
  command.keeps_state = true;
  ModuleGroup group({command}, log, Restarting::kWithPauses);
  const auto ends = wait_for_ends(group, 2);
  REQUIRE(ends.size() == 2);
  CHECK(ends[0].returns);
  CHECK(ends[0].start_again == script.string() + " --session s");
  CHECK(log.str() == "palpate: deformation is started again\nkept\n");
}

TEST_CASE("module group: exit code 2 is bad input, 0 is no failure") {
  // Oracle: the exit codes of core/error.h.
  const Scripts scripts;
  std::ostringstream log;
  ModuleGroup refused({{"haptics", scripts.add("refused", "exit 2"), {}}}, log);
  ModuleGroup closed({{"visualizer", scripts.add("closed", "exit 0"), {}}}, log);
  const auto refused_ends = wait_for_ends(refused, 1);
  const auto closed_ends = wait_for_ends(closed, 1);
  REQUIRE(refused_ends.size() == 1);
  REQUIRE(closed_ends.size() == 1);
  CHECK((refused_ends[0].failed && refused_ends[0].bad_input));
  CHECK_FALSE(closed_ends[0].failed);
}

TEST_CASE("module group: all but one are stopped") {
  // Oracle: what the scripts say, and which process still runs.
  const Scripts scripts;
  const auto polite = [&](const char* name) {
    return scripts.add(name, std::string("trap 'echo ") + name +
                                 " bye; exit 0' TERM; echo up; while :; do sleep 0.05; done");
  };
  std::ostringstream log;
  ModuleGroup group({{"haptics", polite("haptics"), {}}, {"visualizer", polite("visualizer"), {}}},
                    log);
  REQUIRE(wait_until([&] {
    group.poll();
    return log.str() == "up\nup\n";
  }));
  group.stop_all_but("visualizer");
  CHECK(log.str() == "up\nup\nhaptics bye\n");
  CHECK(group.running("visualizer"));
  CHECK_FALSE(group.running("haptics"));
  group.stop();
  CHECK(log.str() == "up\nup\nhaptics bye\nvisualizer bye\n");
}

TEST_CASE("module group: stop is polite first, then not, and the recorder hears the goodbyes") {
  // Oracle: what the scripts say, in order; a deaf one is killed after the patience.
  const Scripts scripts;
  const auto polite = [&](const char* name) {
    return scripts.add(name, std::string("trap 'echo ") + name +
                                 " bye; exit 0' TERM; echo up; while :; do sleep 0.05; done");
  };
  const auto deaf = scripts.add("deaf", "trap '' TERM; echo up; while :; do sleep 0.05; done");
  std::ostringstream log;
  ModuleGroup group({{"recorder", polite("recorder"), {}, false},
                     {"haptics", polite("haptics"), {}},
                     {"visualizer", deaf, {}}},
                    log);
  CHECK(group.reporting_modules() == std::vector<std::string>{"haptics", "visualizer"});
  REQUIRE(wait_until([&] {
    group.poll();
    return log.str() == "up\nup\nup\n";
  }));
  const auto begin = palpate::runtime::monotonic_now_ns();
  group.stop();
  const double took = 1e-9 * static_cast<double>(palpate::runtime::monotonic_now_ns() - begin);
  CHECK(log.str() == "up\nup\nup\nhaptics bye\nrecorder bye\n");
  CHECK(took >= ModuleGroup::kPatience);
  CHECK(took < ModuleGroup::kPatience + 5);
  CHECK_FALSE(group.any_running());
  CHECK(group.deaf() == std::vector<std::string>{"visualizer"});
  CHECK(group.poll().empty());  // asked to end: nothing to report
}
