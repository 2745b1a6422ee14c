// Programs as a script or a service may start them: with standard streams closed, or with an output
// that takes nothing.
#include <catch2/catch.hpp>
#include <filesystem>

#include "modules/core/error.h"
#include "tests/palpate/ball_scene.h"
#include "tests/palpate/typed_command.h"

using namespace palpate;
using palpate::testing::BallScene;
using palpate::testing::type;

namespace {

/// `program WORDS` behind a shell that does this to its streams.
palpate::testing::Outcome behind_shell(const std::string& words, const std::string& streams) {
  return type("/bin/sh", {"-c", "exec " PALPATE_BIN_DIR "/" + words + " " + streams});
}

const std::string kPressForStreams =
    "scripted: {start_m: [0, 0, 0.09], moves: [{to_m: [0, 0, 0.05], duration_s: 1}]}";

struct StreamsRun {
  BallScene ball{kPressForStreams, "duration_s: 2\n"};
  const std::string scene = ball.file().string(), folder = ball.folder().string();

  /// Whether a run so started leaves a recording that is whole.
  void check_records(const std::string& how, const std::string& streams) const {
    const std::string file = folder + "/a.mcap";
    std::filesystem::remove(file);
    CAPTURE(how, streams);
    CHECK(behind_shell("palpate run " + scene + how + " --duration 0.1 --record " + file, streams)
              .code == kExitDone);
    const auto seen = type("palpate", {"inspect", file});
    CAPTURE(seen.said);
    CHECK(seen.code == kExitDone);
    CHECK(seen.said.find("haptic_force") != std::string::npos);
    for (const char* word : {"torn", "warning"}) {
      CHECK(seen.said.find(word) == std::string::npos);
    }
  }
};

}  // namespace

TEST_CASE("closed streams: no recording gets the place, or the words, of standard error") {
  // Oracle: what `inspect` says of a whole recording.
  const StreamsRun run;
  for (const char* streams : {"2>&-", ">&- 2>&-", "<&- >&- 2>&-"}) {
    run.check_records(" --in-process", streams);
  }
}

TEST_CASE("closed streams: a session of processes runs without them") {
  // Oracle: exit code 0 and a whole recording.
  const StreamsRun run;
  for (const char* streams : {">&- 2>&-", "<&- >&-", "<&- 2>&-", "<&- >&- 2>&-"}) {
    run.check_records(" --lockstep", streams);
  }
}

TEST_CASE("lost output: what could not be printed is a failure with its reason, of every command") {
  // Oracle: ENOSPC of /dev/full; the exit codes of core/error.h. diff's 1 says something else.
  const StreamsRun run;
  const std::string a = run.folder + "/a.mcap";
  run.check_records(" --in-process", "");
  for (const auto& words :
       {"palpate check " + run.scene + " --resolved", "palpate inspect " + a,
        "palpate inspect --json " + a, std::string("palpate list models"),
        std::string("palpate token"), std::string("palpate --help"),
        std::string("palpate --version"), std::string("palpate completion"),
        std::string("palpate run --help"), std::string("palpate elements --help"),
        "palpate run " + run.scene + " --in-process --duration 0.02",
        "palpate mesh --json " + run.folder + "/ball.ply", std::string("palpate-haptics --help"),
        std::string("palpate-recorder --version"), "palpate diff " + a + " " + a}) {
    const auto outcome = behind_shell(words, ">/dev/full");
    CAPTURE(words, outcome.said);
    CHECK(outcome.code == (words.starts_with("palpate diff") ? kExitBadInput : kExitFailed));
    CHECK(outcome.said.find("standard output cannot be written") != std::string::npos);
    CHECK(outcome.said.find("No space left on device") != std::string::npos);
    CHECK(behind_shell(words, ">/dev/null").code == kExitDone);
  }
}

TEST_CASE("lost output: `| head` ends a command as ever, without a word") {
  // Oracle: SIGPIPE's 141, or 0 where all was written before the reader went.
  const auto outcome = type(
      "/bin/sh", {"-c", "{ " PALPATE_BIN_DIR "/palpate list scenes; echo code $? >&2; } | true"});
  CAPTURE(outcome.said);
  CHECK((outcome.said == "code 141\n" || outcome.said == "code 0\n"));
}
