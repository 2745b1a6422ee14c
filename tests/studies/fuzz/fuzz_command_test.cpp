#include "studies/fuzz/fuzz_command.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "modules/core/error.h"
#include "studies/fuzz/block_store.h"
#include "tests/studies/chart/folders.h"

namespace palpate::fuzz {
namespace {

TEST_CASE("fuzz command: fifty random scenes run without an unguarded failure, and are kept") {
  // Oracle: invariants of everything published (lockstep.cpp); the second run reads what the first
  // left.
  const chart::testing::WorkFolder folder;
  FuzzOptions options;
  options.out = folder.path;
  options.scenes = 50;
  options.seed = 1;
  std::ostringstream out, again, log;
  CHECK(run_fuzz(options, out, log) == kExitDone);
  CHECK_THAT(out.str(), Catch::Contains("50 scenes") && Catch::Contains(" 0 failed unguarded"));
  INFO(log.str());
  run_fuzz(options, again, log);
  CHECK(again.str() == out.str());
}

TEST_CASE("fuzz command: shards in one folder add up to the tally of one machine") {
  // Oracle: a run without shards. The first block is stored before: it is not run again.
  const chart::testing::WorkFolder alone, shared;
  FuzzOptions options;
  options.scenes = kBlock + 2;
  std::ostringstream expected, merged, told, log;
  for (const auto& folder : {alone.path, shared.path}) {
    BlockStore(folder / "blocks", options.seed, log).write(0, std::vector<Outcome>(kBlock));
  }
  options.out = alone.path;
  run_fuzz(options, expected, log);
  options.out = shared.path;
  for (const std::size_t index : {2u, 1u}) {
    options.shard = report::Shard{index, 2};
    run_fuzz(options, told, log);
  }
  CHECK_THAT(told.str(), Catch::Contains("shard 2/2: 1 points measured here, 1 stored before, 0") &&
                             Catch::Contains("shard 1/2: 0 points measured here, 2 stored before"));
  options.shard.reset();
  run_fuzz(options, merged, log);
  CHECK(merged.str() == expected.str());
  CHECK_THAT(merged.str(), Catch::Contains("102 scenes"));
}

}  // namespace
}  // namespace palpate::fuzz
