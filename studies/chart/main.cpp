#include <CLI/CLI.hpp>
#include <iostream>

#include "modules/core/data_folder.h"
#include "modules/runtime/program.h"
#include "studies/chart/chart_command.h"
#include "studies/chart/fidelity.h"

int main(int argc, char** argv) {
  using namespace palpate;
  CLI::App app("Speed against accuracy: what each model costs and how wrong it is.",
               "palpate chart");
  chart::ChartOptions options;
  options.bullet_program = program_folder() / "palpate-bench-bullet";
  bool quick = false, full = false;
  app.add_option("-o,--out", options.out, "Folder for tables and charts")->capture_default_str();
  app.add_option("--case", options.only_cases,
                 "Only these cases: " + CLI::detail::join(chart::case_names(), ", "))
      ->delimiter(',');
  app.add_option("--model", options.only_models,
                 "Only these models: " + CLI::detail::join(chart::model_hierarchy(), ", "))
      ->delimiter(',');
  app.add_flag("--quick", quick, "Coarse meshes, one step: under 2 minutes");
  app.add_flag("--full", full, "Fine meshes, four steps: hours")->excludes("--quick");
  app.add_flag("--again", options.again, "Measure anew what earlier runs have left in --out");
  app.add_flag("!--no-peers", options.peers, "Without Bullet");
  return runtime::run_program(app, argc, argv, [&] {
    if (quick) options.extent = chart::Extent::kQuick;
    if (full) options.extent = chart::Extent::kFull;
    return chart::run_chart(options, std::cout, std::cerr);
  });
}
