#include <iostream>
#include <optional>
#include <string>

#include "modules/runtime/program.h"
#include "studies/fuzz/fuzz_command.h"

int main(int argc, char** argv) {
  using namespace palpate;
  runtime::Program program("Random scenes, looking for one that fails without a guard noticing.",
                           "palpate fuzz");
  fuzz::FuzzOptions options;
  program.add("-o,--out", options.out, "Folder for outcomes and failing scenes").shows_default();
  const auto scenes = program.add("--scenes", options.scenes, "How many")
                          .range(1, fuzz::kMostScenes)
                          .shows_default();
  program.add("--seed", options.seed, "Of the scenes").range(0, fuzz::kLargestSeed).shows_default();
  const auto only = program.add("--scene", options.only, "Only this one, in detail")
                        .range(0, fuzz::kMostScenes - 1)
                        .excludes(scenes);
  const auto again =
      program.flag("--again", options.again, "Run anew what earlier runs have left in --out")
          .excludes(only);
  std::optional<std::string> shard;
  program.add("--shard", shard, report::kShardHelp).excludes(again).excludes(only);
  program.footer(
      "Exit code: 0 if no scene failed, 1 if one did, 2 for bad input, 130 if it was stopped.");
  return program.run(argc, argv, [&] {
    if (shard) options.shard = report::shard_from(*shard);
    return fuzz::run_fuzz(options, std::cout, std::cerr);
  });
}
