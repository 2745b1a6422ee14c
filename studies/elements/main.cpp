#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include "modules/core/data_folder.h"
#include "modules/runtime/program.h"
#include "modules/runtime/stop_signal.h"
#include "studies/elements/elements_command.h"

int main(int argc, char** argv) {
  using namespace palpate;
  CLI::App app("Finite elements against reference solutions: errors and orders of convergence.",
               "palpate elements");
  elements_bench::ElementsOptions options;
  options.reference_folder = data_folder() / "reference";
  app.add_option("--case", options.cases, "Only these: A, C, D, E; or all")
      ->delimiter(',')
      ->check(CLI::IsMember({"A", "C", "D", "E", "all"}));
  app.add_option("--sizes", options.sizes, "Edge lengths, relative to the case's length")
      ->delimiter(',')
      ->check(CLI::Range(0.01, 1.5));
  app.add_option("-o,--out", options.out, "Folder for CSV files");
  app.add_option("--reference", options.reference_folder, "Folder of the reference tables")
      ->capture_default_str();
  app.add_flag("--quick", options.quick, "Coarse meshes, small loads: about a minute");
  return runtime::run_program(app, argc, argv, [&] {
    if (std::count(options.cases.begin(), options.cases.end(), "all") > 0) options.cases.clear();
    const runtime::StopSignal signal;
    return elements_bench::run_elements(
        options, [&] { return signal.requested(); }, std::cout, std::cerr);
  });
}
