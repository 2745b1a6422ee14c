#include "palpate/completion.h"

#include <catch2/catch.hpp>

using namespace palpate::launcher;

namespace {

using Words = std::vector<std::string>;

const Words kHelp{"Speed against accuracy.",
                  "Usage: palpate chart [OPTIONS] SCENE",
                  "",
                  "Positionals:",
                  "  SCENE TEXT REQUIRED         Scene file, or the name of a shipped scene",
                  "",
                  "Options:",
                  "  -h,--help                   Print this help message and exit",
                  "  -o,--out TEXT=out/accuracy  Folder for tables and charts",
                  "  --case TEXT ...             Only these cases: ball, block, liver",
                  "  --kind TEXT:{hollow,solid}",
                  "                              Only one",
                  "  --quick Excludes: --full    Coarse meshes",
                  "",
                  "Exit code: 0"};

}  // namespace

TEST_CASE("completion: the words that a command's own help names") {
  // Oracle: the help above, by hand.
  const CommandWords words = words_in(kHelp);
  CHECK(words.options == Words{"--help", "--out", "--case", "--kind", "--quick"});
  CHECK(words.values.size() == 4);  // -o and --out
  CHECK(words.values.at("--case").several);
  CHECK(words.values.at("--case").allowed == Words{"ball", "block", "liver"});
  CHECK(words.values.at("--kind").allowed == Words{"hollow", "solid"});
  CHECK(words.places.count("SCENE") == 1);
}

TEST_CASE("completion: a scene's name is offered where a scene may stand, and nowhere else") {
  // Oracle: by hand.
  const CommandWords words = words_in(kHelp);
  const Words scenes{"liver_probe"};
  const auto offered = [&](const Words& typed) { return completions(words, typed, scenes); };
  CHECK(offered({"l"}).front() == "liver_probe");
  CHECK(offered({"--quick", "l"}).front() == "liver_probe");
  CHECK(offered({"--"}) == words.options);
  CHECK(offered({"--case", "l"}) == Words{"ball", "block", "liver"});
  CHECK(offered({"--case", "ball", "l"}) == Words{"ball", "block", "liver"});
  CHECK(offered({"--kind", ""}) == Words{"hollow", "solid"});
  CHECK(offered({"--out", "l"}).empty());  // the shell's files
  CHECK(offered({"--out", "here", "l"}).front() == "liver_probe");
}
