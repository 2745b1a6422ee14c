#include <iostream>
#include <optional>
#include <string>

#include "modules/runtime/program.h"
#include "studies/report/progress.h"
#include "studies/stability/stability_command.h"

int main(int argc, char** argv) {
  using namespace palpate;
  runtime::Program program("Stability atlas: where each method fails, measured and predicted.",
                           "palpate stability");
  stability::StabilityOptions options;
  program.add("-o,--out", options.out, "Folder for tables and charts").shows_default();
  program.add("--only", options.only_maps, "Only these maps").one_of(stability::map_names());
  program.add("--series", options.only_series, "Only these models or loops");
  program.flag("--quick", options.quick, "Fewer models and values: under 90 s");
  const auto again =
      program.flag("--again", options.again, "Measure anew what earlier runs have left in --out");
  std::optional<std::string> shard;
  program.add("--shard", shard, report::kShardHelp).excludes(again);
  program.footer(report::kExitCodesHelp);
  return program.run(argc, argv, [&] {
    if (shard) options.shard = report::shard_from(*shard);
    return stability::run_stability(options, std::cout, std::cerr);
  });
}
