#include <iostream>
#include <optional>
#include <string>

#include "modules/core/data_folder.h"
#include "modules/runtime/program.h"
#include "studies/chart/chart_command.h"
#include "studies/chart/fidelity.h"
#include "studies/report/progress.h"

namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace palpate;
  runtime::Program program("Speed against accuracy: what each model costs and how wrong it is.",
                           "palpate chart");
  chart::ChartOptions options;
  options.bullet_program = program_folder() / "palpate-bench-bullet";
  bool quick = false, full = false;
  program.add("-o,--out", options.out, "Folder for tables and charts").shows_default();
  program.add("--case", options.only_cases, "Only these cases: " + listed(chart::case_names()));
  program.add("--model", options.only_models,
              "Only these models: " + listed(chart::model_hierarchy()));
  const auto coarse = program.flag("--quick", quick, "Coarse meshes, one step: under 2 minutes");
  program.flag("--full", full, "Fine meshes, four steps: hours").excludes(coarse);
  program.add("--places", options.places, "Of organs, the first so many of 22").range(1, 22);
  const auto again =
      program.flag("--again", options.again, "Measure anew what earlier runs have left in --out");
  std::optional<std::string> shard;
  program.add("--shard", shard, report::kShardHelp).excludes(again);
  program.flag_off("--no-peers", options.peers, "Without Bullet");
  program.footer(report::kExitCodesHelp);
  return program.run(argc, argv, [&] {
    if (shard) options.shard = report::shard_from(*shard);
    if (quick) options.extent = chart::Extent::kQuick;
    if (full) options.extent = chart::Extent::kFull;
    return chart::run_chart(options, std::cout, std::cerr);
  });
}
