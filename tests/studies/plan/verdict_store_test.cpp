#include "studies/plan/verdict_store.h"

#include <catch2/catch.hpp>
#include <limits>
#include <sstream>

#include "tests/scratch_folder.h"
#include "tests/studies/damages.h"

namespace palpate::plan {
namespace {

TEST_CASE("verdict store: a verdict comes back bit by bit, and only for what it is of") {
  // Oracle: what was written.
  const ScratchFolder folder;
  std::ostringstream log;
  const VerdictStore store(folder.path(), "this scene", log);
  StoredVerdict written;
  written.machine = "a machine";
  Verdict& verdict = written.verdict;
  verdict.candidate.nodes = 250;
  verdict.errors.force = 1.0 / 3;
  verdict.errors.surface = std::numeric_limits<double>::infinity();
  verdict.errors.feel.sideways = 0.1 + 0.2;
  verdict.total_load = 1e-300;
  verdict.node_count = 256;
  verdict.failures = {"too slow", "too \"soft\""};
  store.write("ball", written);
  StoredVerdict read;
  REQUIRE(store.read("ball", verdict.candidate, read));
  CHECK(read.machine == written.machine);
  CHECK(read.verdict.errors.force == verdict.errors.force);
  CHECK(read.verdict.errors.surface == verdict.errors.surface);
  CHECK(read.verdict.errors.feel.sideways == verdict.errors.feel.sideways);
  CHECK(read.verdict.total_load == verdict.total_load);
  CHECK(read.verdict.node_count == 256);
  CHECK(read.verdict.failures == verdict.failures);
  CHECK_FALSE(store.read("liver", verdict.candidate, read));
  CHECK_FALSE(VerdictStore(folder.path(), "another", log).read("ball", verdict.candidate, read));
  CHECK_FALSE(VerdictStore({}, "this scene", log).read("ball", verdict.candidate, read));
  CHECK(log.str().empty());
}

TEST_CASE("verdict store: a verdict that is not whole is named, and is as if it was not there") {
  // Oracle: definition.
  const ScratchFolder folder;
  std::ostringstream ignored;
  StoredVerdict stored;
  stored.verdict.errors.force = 0.25;
  const VerdictStore written(folder.path(), "this scene", ignored);
  written.write("ball", stored);
  const std::string file = written.key("ball", stored.verdict.candidate) + ".json";
  const std::string whole = text_in(folder / file);
  std::vector<std::string> texts = damaged(whole);
  const std::string force = "\"force\" : 0.25";
  for (const char* other : {"NaN", "\"abc\"", "1e999", "[[", "-5"}) {
    texts.push_back(whole);
    texts.back().replace(whole.find(force) + 10, 4, other);
  }
  for (const std::string& text : texts) {
    INFO(text);
    folder.write(file, text);
    std::ostringstream log;
    StoredVerdict read;
    const VerdictStore store(folder.path(), "this scene", log);
    CHECK_FALSE(store.read("ball", stored.verdict.candidate, read));
    CHECK_THAT(log.str(), Catch::Contains(file + ": was "));
  }
}

}  // namespace
}  // namespace palpate::plan
