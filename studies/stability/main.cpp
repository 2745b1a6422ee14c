#include <CLI/CLI.hpp>
#include <iostream>

#include "modules/runtime/program.h"
#include "studies/stability/stability_command.h"

int main(int argc, char** argv) {
  using namespace palpate;
  CLI::App app("Stability atlas: where each method fails, measured and predicted.",
               "palpate stability");
  stability::StabilityOptions options;
  app.add_option("-o,--out", options.out, "Folder for tables and charts")->capture_default_str();
  app.add_option("--only", options.only_maps, "Only these maps")
      ->delimiter(',')
      ->check(CLI::IsMember(stability::map_names()));
  app.add_option("--series", options.only_series, "Only these models or loops")->delimiter(',');
  app.add_flag("--quick", options.quick, "Fewer models and values: under 90 s");
  app.add_flag("--again", options.again, "Measure anew what earlier runs have left in --out");
  return runtime::run_program(
      app, argc, argv, [&] { return stability::run_stability(options, std::cout, std::cerr); });
}
