// The programs as they are typed, in processes of their own.
#include <catch2/catch.hpp>
#include <fstream>

#include "modules/bus/keys.h"
#include "modules/core/error.h"
#include "tests/palpate/ball_scene.h"
#include "tests/palpate/typed_command.h"

using namespace palpate;
using Catch::Contains;
using testing::BallScene;
using testing::own_bus_options;
using testing::type;
using testing::wait_until;

TEST_CASE("command line: --help lists every command and is no error") {
  // Oracle: the commands of the design.
  const auto help = type("palpate", {"--help"});
  CHECK(help.code == kExitDone);
  for (const char* command :
       {"run", "replay", "inspect", "diff", "check", "mesh", "new", "list", "chart"}) {
    CHECK_THAT(help.said, Contains(command));
    CHECK(type("palpate", {command, "--help"}).code == kExitDone);
  }
  for (const char* program : {"certify", "plan", "stability", "fuzz"}) {
    CHECK_THAT(help.said, Contains(program));
  }
}

TEST_CASE("command line: help WORD is WORD --help, and the shell is told what may follow") {
  // Oracle: the help itself; the options it lists.
  CHECK(type("palpate", {"help"}).said == type("palpate", {"--help"}).said);
  const auto help = type("palpate", {"help", "check"});
  CHECK(help.code == kExitDone);
  CHECK(help.said == type("palpate", {"check", "--help"}).said);
  const auto commands = type("palpate", {"completion", "ch"});
  CHECK_THAT(commands.said, Contains("check\n") && Contains("chart\n") && Contains("run\n"));
  const auto options = type("palpate", {"completion", "check", "--re"});
  CHECK_THAT(options.said, Contains("--resolved\n") && Contains("--set\n") && !Contains("stomach"));
  CHECK_THAT(type("palpate", {"completion", "run", "sto"}).said, Contains("stomach_probe\n"));
  CHECK_THAT(type("palpate", {"completion", "plan", "--"}).said,
             Contains("--verify\n") && Contains("--points\n"));
  CHECK_THAT(type("palpate", {"completion", "plan", "l"}).said, Contains("liver_probe\n"));
  CHECK_THAT(type("palpate", {"completion", "list", "s"}).said,
             Contains("scenes\n") && Contains("shapes\n") && !Contains("stomach_probe"));
  CHECK_THAT(type("palpate", {"completion", "chart", "--case", "l"}).said,
             Contains("liver_4mm\n") && !Contains("liver_probe"));
  const auto script = type("palpate", {"completion"});
  CHECK_THAT(script.said, Contains("complete -o default -F _palpate palpate"));
}

TEST_CASE("command line: what is not a command or option is bad input") {
  // Oracle: the exit codes of core/error.h.
  const std::vector<std::vector<std::string>> wrong{
      {},
      {"rum"},
      {"run", "a.yaml", "--domain", "300"},
      {"run", "a.yaml", "--duration", "-1"},
      {"run", "a.yaml", "--duration", "nan"},
      {"run", "a.yaml", "--duration", "0"},
      {"replay", "a.mcap", "--rerun", "haptics", "--duration", "0"},
      {"replay", "a.mcap", "--lockstep"},
      {"run", "a.yaml", "--in-process", "--only", "haptics"},
      {"run", "a.yaml", "--lockstep", "--only", "haptics"},
      {"run", "a.yaml", "--in-process", "--frames", "f"},
      {"run", "a.yaml", "--in-process", "--domain", "3"},
      {"check"},
      {"mesh", "a.ply", "--near-unit", "mm"},
      {"mesh", "a.ply", "--radius-m", "0.01"},
      {"mesh"}};
  for (const auto& arguments : wrong) CHECK(type("palpate", arguments).code == kExitBadInput);
  CHECK_THAT(type("palpate", {"mesh", "a.ply", "--near-unit", "mm"}).said,
             Contains("--near-unit requires --near"));
  CHECK_THAT(type("palpate", {"rum"}).said, Contains("no command 'rum'; there are run replay"));
  CHECK_THAT(type("palpate", {"mesh", "a.ply", "--nodes", "-5"}).said, Contains("-5 not in range"));
  for (const char* seed :
       {"-1", "1000000000000000001", "18446744073709551616", "99999999999999999999999"}) {
    const auto refused = type("palpate", {"fuzz", "--seed", seed, "--scenes", "1"});
    CHECK(refused.code == kExitBadInput);
    CHECK_THAT(refused.said, Contains(std::string("--seed: Value ") + seed + " not in range"));
  }
  for (const char* scene : {"-1", "10000000", "18446744073709551616"}) {
    const auto refused = type("palpate", {"fuzz", "--scene", scene});
    CHECK(refused.code == kExitBadInput);
    CHECK_THAT(refused.said, Contains(std::string("--scene: Value ") + scene + " not in range"));
  }
  CHECK_THAT(type("palpate", {"run", "a.yaml", "--duration", "nan"}).said,
             Contains("--duration: nan is not a number"));
}

TEST_CASE("command line: an empty entry of a list is bad input") {
  // Oracle: the message; the parser itself passes over it.
  for (const std::string list : {"haptics,,collision", ",", "haptics,", ",haptics"}) {
    for (const auto& words : {std::vector<std::string>{"--only", list}, {"--only=" + list}}) {
      auto arguments = words;
      arguments.insert(arguments.begin(), {"run", "a.yaml"});
      const auto outcome = type("palpate", arguments);
      CHECK(outcome.code == kExitBadInput);
      CHECK(outcome.said == "palpate: --only " + list + ": an entry between its commas is empty\n");
    }
  }
}

TEST_CASE("command line: a list without an entry is called empty") {
  // Oracle: the message.
  for (const std::vector<std::string>& list :
       {std::vector<std::string>{"--only", ""}, {"--only="}}) {
    auto arguments = list;
    arguments.insert(arguments.begin(), {"run", "a.yaml"});
    const auto outcome = type("palpate", arguments);
    CHECK(outcome.code == kExitBadInput);
    CHECK(outcome.said == "palpate: --only: an empty list names nothing\n");
  }
}

TEST_CASE("command line: a summary whose folder vanishes meanwhile is a failure, and is told") {
  // Oracle: exit code 1; the summary is on the standard output all the same.
  const BallScene scene;
  const auto folder = scene.folder() / "results";
  std::filesystem::create_directory(folder);
  launcher::ChildProcess run(
      std::filesystem::path(PALPATE_BIN_DIR) / "palpate",
      {"run", scene.file().string(), "--in-process", "--duration", "20", "--record",
       (scene.folder() / "a.mcap").string(), "--summary", (folder / "a.txt").string()});
  REQUIRE(wait_until([&] { return std::filesystem::exists(scene.folder() / "a.mcap"); }));
  std::filesystem::remove_all(folder);
  REQUIRE(wait_until([&] { return run.ended().has_value(); }));
  std::string said;
  for (const auto& line : run.take_lines()) said += line + "\n";
  CHECK(WEXITSTATUS(*run.ended()) == kExitFailed);
  CHECK_THAT(said, Catch::Contains("\nprobe finger") &&
                       Catch::Contains("there is no folder " + folder.string() +
                                       "; the summary is not in a file"));
}

TEST_CASE("command line: too few open files are an error, and nothing is waited for") {
  // Oracle: exit code 1, or the session's own 0; of these limits one let Fast DDS start without a
  // socket, and the launcher waited for ever for modules that it could not hear.
  const BallScene scene;
  for (int files = 14; files <= 22; ++files) {
    const auto options = own_bus_options();
    const auto outcome = type(
        "/bin/sh",
        {"-c", "ulimit -n " + std::to_string(files) + "; exec " PALPATE_BIN_DIR "/palpate run " +
                   scene.file().string() + " --headless --duration 0.1 --no-realtime --session " +
                   options.session + " --domain " + std::to_string(options.domain)});
    CAPTURE(files, outcome.said);
    CHECK((outcome.code == kExitFailed || outcome.code == kExitDone));
  }
}

TEST_CASE("command line: options that leave nothing to do, or leave another out, are refused") {
  // Oracle: exit code 2, the words. They were taken, and the rest ignored.
  const BallScene scene;
  const std::string file = scene.file().string(), folder = scene.folder().string();
  std::ofstream(folder + "/hosts.yaml")
      << "palpate_hosts: 1\nhosts: [{name: a, address: 127.0.0.1, modules: [haptics, "
         "deformation]}]\n";
  std::ofstream(folder + "/more.yaml")
      << "palpate_hosts: 1\nhosts: [{name: a, address: 127.0.0.1, modules: [haptics, collision, "
         "deformation, deformation_2]}]\n";
  for (const auto& [typed, named] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"run", file, "--headless", "--hosts", folder + "/more.yaml", "--host", "a"},
            "more.yaml: the scene has no module 'deformation_2'; it has deformation, collision, "},
           {{"run", file, "--only", "visualizer", "--no-visualizer"}, "leaves nothing to start"},
           {{"run", file, "--only", "recorder"}, "a recorder needs --record"},
           {{"run", file, "--headless", "--hosts", folder + "/hosts.yaml", "--host", "a"},
            "no host has the module 'collision'"},
           {{"token", "--session", "*"}, "session: \"*\": allowed are 1 to 64"},
           {{"keys", folder + "/no/k"}, "there is no folder " + folder + "/no"}}) {
    const auto outcome = type("palpate", typed);
    CAPTURE(typed, outcome.said);
    CHECK(outcome.code == kExitBadInput);
    CHECK_THAT(outcome.said, Catch::Contains(named));
  }
  CHECK_FALSE(std::filesystem::exists(folder + "/no"));
}

TEST_CASE("command line: a summary that cannot be written is refused before anything starts") {
  // Oracle: exit code 2 and one line by hand.
  const BallScene scene;
  const std::string folder = scene.folder().string(), no = folder + "/no";
  for (const auto& [file, why] : std::vector<std::pair<std::string, std::string>>{
           {folder, "it is a folder"}, {no + "/a.txt", "there is no folder " + no}}) {
    const auto outcome = type("palpate", {"run", scene.file().string(), "--in-process",
                                          "--duration", "0.1", "--summary", file});
    CHECK(outcome.code == kExitBadInput);
    CHECK(outcome.said == "palpate: " + file + ": cannot be written: " + why + "\n");
  }
}

TEST_CASE("command line: every command says its version, and diff its exit codes") {
  // Oracle: the version that the program itself says; the codes of core/error.h.
  const auto version = type("palpate", {"--version"});
  CHECK(version.code == kExitDone);
  for (const char* command : {"run", "replay", "inspect", "diff", "check", "mesh", "chart", "plan",
                              "stability", "fuzz", "paper", "calibrate", "elements"}) {
    INFO(command);
    const auto said = type("palpate", {command, "--version"});
    CHECK(said.code == kExitDone);
    CHECK(said.said == version.said);
    CHECK(type("palpate", {command, "--help"}).code == kExitDone);
  }
  CHECK_THAT(type("palpate", {"diff", "--help"}).said, Contains("0 if they are equal, 1 if they"));
}

TEST_CASE("command line: no command writes over what it reads, or to an empty path") {
  // Oracle: the message, the exit code, and the file's bytes.
  const BallScene scene;
  const std::string file = scene.file().string(), folder = scene.folder().string();
  const std::string mesh = folder + "/ball.ply";
  const auto size = std::filesystem::file_size(mesh);
  const std::vector<std::vector<std::string>> wrong{
      {"run", file, "--record", file},
      {"run", file, "--in-process", "--duration", "0.1", "--record", mesh},
      {"run", file, "--summary", folder + "/./" + scene.file().filename().string()},
      {"replay", mesh, file, "--record", mesh},
      {"mesh", mesh, "-o", mesh},
      {"diff", mesh, file, "--csv", file},
      {"plan", file, "-o", file},
      {"run", file, "--record", ""},
      {"run", file, "--frames", ""},
      {"run", ""},
      {"mesh", mesh, "-o", ""}};
  for (const auto& arguments : wrong) {
    const auto outcome = type("palpate", arguments);
    CAPTURE(arguments, outcome.said);
    CHECK(outcome.code == kExitBadInput);
    const bool named = outcome.said.find("overwritten") != std::string::npos ||
                       outcome.said.find("is no recording") != std::string::npos ||
                       outcome.said.find("an empty path names no file") != std::string::npos;
    CHECK(named);
  }
  CHECK(std::filesystem::file_size(mesh) == size);
}

TEST_CASE("command line: a bad scene is refused by every program with file and line") {
  // Oracle: the message and exit code 2.
  const BallScene scene("topic: {start_m: [0, 0, 0.09]}", "wrong_key: 1\n");
  const std::string file = scene.file().string();
  const std::string place = file + ":12: key 'wrong_key'";
  for (const char* module : {"palpate-haptics", "palpate-collision", "palpate-deformation"}) {
    const auto outcome = type(module, {file});
    CHECK(outcome.code == kExitBadInput);
    CHECK_THAT(outcome.said, Contains(place));
  }
  for (const char* command : {"run", "check"}) {
    const auto outcome = type("palpate", {command, file});
    CHECK(outcome.code == kExitBadInput);
    CHECK_THAT(outcome.said, Contains(place));
  }
}

TEST_CASE("command line: a recording that cannot be written is refused before anything starts") {
  // Oracle: exit code 2 and one line by hand: neither a session nor a module has said a word.
  const BallScene scene;
  const std::string folder = scene.folder().string(), no = folder + "/no";
  for (const auto& [target, why] : std::vector<std::pair<std::string, std::string>>{
           {no + "/a.mcap", "there is no folder " + no},
           {folder, "it is there and no regular file"},
           {"/dev/full", "it is there and no regular file"}}) {
    for (const std::string mode : {"--headless", "--lockstep", "--in-process"}) {
      const auto outcome = type(
          "palpate", {"run", scene.file().string(), "--duration", "0.1", "--record", target, mode});
      CAPTURE(target, mode);
      CHECK(outcome.code == kExitBadInput);
      CHECK(outcome.said == "palpate: " + target + ": cannot be recorded to: " + why + "\n");
    }
  }
}

TEST_CASE("command line: keys that cannot be used are refused before anything starts") {
  // Oracle: exit code 2 and one line by hand: neither a session nor a module has said a word.
  using bus::Authority, bus::valid_from_now, bus::write_keys;
  constexpr std::chrono::hours kHour(1);
  const BallScene scene;
  const auto folder = scene.folder();
  const auto now = valid_from_now(kHour);
  write_keys(folder / "good", Authority(now), now);
  write_keys(folder / "old", Authority(now), {now.from - kHour, now.from});
  std::filesystem::copy(folder / "good", folder / "mixed");
  std::filesystem::copy(folder / "old/authority.pem", folder / "mixed",
                        std::filesystem::copy_options::overwrite_existing);
  std::filesystem::copy(folder / "good", folder / "part");
  std::filesystem::remove(folder / "part/collision.key");
  const auto run = [&](const std::string& keys, const std::string& mode) {
    return type("palpate", {"run", scene.file().string(), "--duration", "0.1", mode, "--secure",
                            (folder / keys).string()});
  };
  for (const auto& [keys, what] : std::vector<std::pair<std::string, std::string>>{
           {"old", "palpate.pem: expired at "},
           {"mixed", "palpate.pem: is not signed by the authority.pem beside it; copy "},
           {"part", "collision.key: no such file; `palpate keys` makes them"}}) {
    for (const std::string mode : {"--headless", "--lockstep"}) {
      const auto outcome = run(keys, mode);
      CAPTURE(outcome.said);
      CHECK(outcome.code == kExitBadInput);
      CHECK_THAT(outcome.said,
                 Catch::StartsWith("palpate: keys: " + (folder / keys / what).string()));
      CHECK(std::ranges::count(outcome.said, '\n') == 1);
    }
  }
  CHECK(run("good", "--lockstep").code == kExitDone);
}

TEST_CASE("command line: a recording that is not there is bad input") {
  // Oracle: the exit codes of core/error.h.
  const auto outcome = type("palpate", {"inspect", "/nowhere/a.mcap"});
  CHECK(outcome.code == kExitBadInput);
  CHECK_THAT(outcome.said, Contains("/nowhere/a.mcap"));
  CHECK(type("palpate", {"replay", "/nowhere/a.mcap"}).code == kExitBadInput);
}

TEST_CASE("command line: mesh writes what it was asked for") {
  // Oracle: the file.
  const BallScene scene;
  const auto output = scene.folder() / "out.stl";
  const auto outcome =
      type("palpate", {"mesh", (scene.folder() / "ball.ply").string(), "-o", output.string()});
  CHECK(outcome.code == kExitDone);
  CHECK(std::filesystem::exists(output));
}
