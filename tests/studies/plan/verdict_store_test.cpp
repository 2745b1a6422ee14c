#include "studies/plan/verdict_store.h"

#include <catch2/catch.hpp>
#include <limits>

#include "tests/scratch_folder.h"

namespace palpate::plan {
namespace {

TEST_CASE("verdict store: a verdict comes back bit by bit, and only for what it is of") {
  // Oracle: what was written.
  const ScratchFolder folder;
  const VerdictStore store(folder.path(), "this scene");
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
  CHECK_FALSE(VerdictStore(folder.path(), "another").read("ball", verdict.candidate, read));
  CHECK_FALSE(VerdictStore({}, "this scene").read("ball", verdict.candidate, read));
}

}  // namespace
}  // namespace palpate::plan
