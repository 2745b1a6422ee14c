#include <algorithm>
#include <iostream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/runtime/program.h"
#include "studies/elements/elements_command.h"
#include "studies/report/progress.h"

int main(int argc, char** argv) {
  using namespace palpate;
  runtime::Program program(
      "Finite elements against reference solutions: errors and orders of convergence.",
      "palpate elements");
  elements_bench::ElementsOptions options;
  options.reference_folder = data_folder() / "reference";
  program.add("--case", options.cases, "Only these: A, C, D, E; or all")
      .one_of({"A", "C", "D", "E", "all"});
  program.add("--sizes", options.sizes, "Edge lengths, relative to the case's length")
      .range(0.01, 1.5);
  program.add("-o,--out", options.out, "Folder for CSV files");
  program.add("--reference", options.reference_folder, "Folder of the reference tables")
      .shows_default();
  program.flag("--quick", options.quick, "Coarse meshes, small loads: about a minute");
  program.footer(report::kExitCodesHelp);
  return program.run(argc, argv, [&] {
    if (std::count(options.cases.begin(), options.cases.end(), "all") > 0) options.cases.clear();
    const StopSignal signal;
    return elements_bench::run_elements(
        options,
        [&] {
          if (signal.requested()) throw Interrupted("stopped");
        },
        std::cout, std::cerr);
  });
}
