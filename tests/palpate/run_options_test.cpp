#include "palpate/run_options.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "modules/core/error.h"
#include "tests/scratch_folder.h"

using namespace palpate::launcher;

namespace {

std::vector<std::string> names(const std::vector<ModuleCommand>& commands) {
  std::vector<std::string> result;
  for (const auto& command : commands) result.push_back(command.module);
  return result;
}

RunOptions some_run() {
  RunOptions options;
  options.scene = "/scenes/a.yaml";
  options.bus.session = "s1";
  options.bus.domain = 9;
  return options;
}

bool has(const ModuleCommand& command, const std::string& argument) {
  return std::find(command.arguments.begin(), command.arguments.end(), argument) !=
         command.arguments.end();
}

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("run options: every module gets the scene and the session") {
  // Oracle: the command lines, by hand.
  const auto commands = module_commands(some_run(), "/bin/p");
  CHECK(names(commands) == Names{"deformation", "collision", "haptics", "visualizer"});
  CHECK(command_text(commands[2]) ==
        "/bin/p/palpate-haptics /scenes/a.yaml --session s1 --domain 9");
}

TEST_CASE("run options: a recorder comes first, and knows whom it is to hear") {
  // Oracle: definition.
  auto options = some_run();
  options.record = "out.mcap";
  const auto commands = module_commands(options, "/bin/p");
  const std::string command = "/bin/p/palpate-recorder out.mcap --session s1 --domain 9";
  const std::string hears = " --hears deformation,collision,haptics,visualizer";
  CHECK(command_text(commands[0]) == command + hears);
  options.record_topics = {"all", "contacts=5"};
  CHECK(command_text(module_commands(options, "/bin/p")[0]) ==
        command + " --topics all,contacts=5" + hears);
  options.record_topics = {"contact"};
  CHECK_THROWS_AS(module_commands(options, "/bin/p"), palpate::InputError);
  options.record_topics.clear();
  CHECK_FALSE(commands[0].reports_status);
  CHECK(commands[1].reports_status);
}

TEST_CASE("run options: a window stays, and its q ends the run, where it is this run's own") {
  // Oracle: definition.
  auto options = some_run();
  CHECK(window_stays(options));
  CHECK(has(module_commands(options, "")[3], "--ends-run"));
  options.lockstep = true;
  CHECK(has(module_commands(options, "")[3], "--stays"));
  CHECK_FALSE(has(module_commands(options, "")[3], "--ends-run"));
  options.close = true;
  CHECK_FALSE(window_stays(options));
  CHECK_FALSE(has(module_commands(options, "")[3], "--stays"));
  options = some_run();
  options.only = {"visualizer"};
  CHECK_FALSE(window_stays(options));
  CHECK_FALSE(has(module_commands(options, "")[0], "--ends-run"));
  options = some_run();
  options.headless = true;
  options.frames = "out";
  CHECK_FALSE(window_stays(options));
}

TEST_CASE("run options: a visualizer that nobody could see is left out") {
  // Oracle: definition.
  auto options = some_run();
  options.headless = true;
  CHECK(names(module_commands(options, "")) == Names{"deformation", "collision", "haptics"});
  options.frames = "out";
  const auto drawing = module_commands(options, "");
  REQUIRE(drawing.size() == 4);
  CHECK(has(drawing[3], "--headless"));
  CHECK(has(drawing[3], "out"));
  options.visualizer = false;
  CHECK(module_commands(options, "").size() == 3);
}

TEST_CASE("run options: --only starts those and refuses names that do not exist") {
  // Oracle: definition, and the message.
  auto options = some_run();
  options.only = {"haptics", "collision"};
  CHECK(names(module_commands(options, "")) == Names{"collision", "haptics"});
  options.only = {"haptic"};
  CHECK_THROWS_WITH(module_commands(options, ""),
                    "--only: there is no module 'haptic'; there are deformation, collision, "
                    "haptics, visualizer");
  CHECK_THROWS_AS(module_commands(options, ""), palpate::InputError);
}

TEST_CASE("run options: each process of deformation is a module of its own") {
  // Oracle: names and command lines, by hand.
  auto options = some_run();
  options.headless = true;
  const auto commands = module_commands(options, "/bin/p", 2);
  CHECK(names(commands) == Names{"deformation", "deformation_2", "collision", "haptics"});
  CHECK(command_text(commands[0]) ==
        "/bin/p/palpate-deformation /scenes/a.yaml --session s1 --domain 9");
  CHECK(command_text(commands[1]) ==
        "/bin/p/palpate-deformation /scenes/a.yaml --session s1 --domain 9 --process 2");
  options.lockstep = true;
  CHECK(has(module_commands(options, "", 2)[3], "deformation,deformation_2,collision,haptics"));
  options.lockstep = false;
  options.only = {"deformation_2"};
  CHECK(names(module_commands(options, "", 2)) == Names{"deformation_2"});
  CHECK_THROWS_WITH(module_commands(options, ""), Catch::Contains("no module 'deformation_2'"));
}

TEST_CASE(
    "run options: deformation alone asks for huge pages, beside what the user asks of malloc") {
  // Oracle: the names that glibc documents.
  ::setenv("GLIBC_TUNABLES", "glibc.malloc.arena_max=2", 1);
  const auto commands = module_commands(some_run(), "/bin/p");
  ::unsetenv("GLIBC_TUNABLES");
  const Names wished{"GLIBC_TUNABLES=glibc.malloc.arena_max=2:glibc.malloc.hugetlb=1"};
  CHECK(commands[0].environment == wished);
  for (std::size_t k = 1; k < commands.size(); ++k) CHECK(commands[k].environment.empty());
  CHECK(module_commands(some_run(), "/bin/p")[0].environment ==
        Names{"GLIBC_TUNABLES=glibc.malloc.hugetlb=1"});
  ::setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=0", 1);
  CHECK(module_commands(some_run(), "/bin/p")[0].environment ==
        Names{"GLIBC_TUNABLES=glibc.malloc.hugetlb=0"});
  ::unsetenv("GLIBC_TUNABLES");
}

TEST_CASE("run options: --no-realtime reaches every module") {
  // Oracle: definition.
  auto options = some_run();
  options.realtime = false;
  for (const auto& command : module_commands(options, "")) CHECK(has(command, "--no-realtime"));
}

TEST_CASE("run options: random session names are acceptable and differ") {
  // Oracle: the rule of bus::Bus; 32 random bits repeat within 100 names once in a million.
  std::set<std::string> seen;
  for (int i = 0; i < 100; ++i) {
    const auto name = random_session_name();
    CHECK(name.size() == 9);
    CHECK(name.find_first_not_of("s0123456789abcdef") == std::string::npos);
    seen.insert(name);
  }
  CHECK(seen.size() == 100);
}

TEST_CASE("run options: a recorder that comes back writes another part") {
  // Oracle: the names.
  const ModuleCommand recorder{"recorder", "palpate-recorder", {"out/run.mcap", "--session", "s"}};
  CHECK(again(recorder, 0).arguments[0] == "out/run.mcap");
  CHECK(again(recorder, 1).arguments[0] == "out/run.part2.mcap");
  CHECK(again(recorder, 2).arguments[0] == "out/run.part3.mcap");
  const ModuleCommand other{"collision", "palpate-collision", {"scene.yaml"}};
  CHECK(again(other, 3).arguments == other.arguments);
}

TEST_CASE("run options: haptics that comes back joins a session that runs") {
  // Oracle: its devices read the session's time, which it does not know before it hears of it.
  const ModuleCommand haptics{"haptics", "p", {"scene.yaml"}};
  CHECK(again(haptics, 0).arguments == Names{"scene.yaml"});
  CHECK(again(haptics, 1).arguments == Names{"scene.yaml", "--joins"});
  CHECK(again(again(haptics, 1), 2).arguments == Names{"scene.yaml", "--joins"});
}

TEST_CASE("run options: pictures of an earlier run are refused, or go before the first new one") {
  // Oracle: the files left; a picture of something else stays.
  const palpate::ScratchFolder folder;
  auto options = some_run();
  options.frames = folder / "frames";
  check_frames(options);  // makes it
  CHECK_NOTHROW(check_frames(options));
  folder.write("frames/frame_000003.000.png", "\x89PNG");
  folder.write("frames/photo.png", "\x89PNG");
  CHECK_THROWS_WITH(check_frames(options),
                    Catch::Contains("holds pictures of a run already (frame_000003.000.png)") &&
                        Catch::EndsWith("or --overwrite"));
  options.overwrite = true;
  CHECK_NOTHROW(check_frames(options));
  CHECK(std::filesystem::exists(folder / "frames/frame_000003.000.png"));  // a check takes nothing
  clear_frames(options);
  CHECK_FALSE(std::filesystem::exists(folder / "frames/frame_000003.000.png"));
  CHECK(std::filesystem::exists(folder / "frames/photo.png"));
}
