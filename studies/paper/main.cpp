#include <iostream>

#include "modules/runtime/program.h"
#include "studies/paper/paper_command.h"
#include "studies/report/progress.h"

int main(int argc, char** argv) {
  using namespace palpate;
  runtime::Program program(
      "The figures and numbers of Hong et al., made anew: CSV files and pictures.",
      "palpate paper");
  paper::PaperOptions options;
  program.add("-o,--out", options.out, "Folder to write to").shows_default();
  program.add("--only", options.only, "Only these: figures 1 to 4, speed")
      .one_of(paper::paper_parts());
  program.flag("--quick", options.quick, "Short runs, Figure 4 on 550 nodes: under a minute");
  program
      .add("--budget-s", options.budget, "Wall time after which Figure 4 is cut short, and says so")
      .range(1.0, 1e6)
      .shows_default();
  program.footer(report::kExitCodesHelp);
  return program.run(argc, argv, [&] { return paper::run_paper(options, std::cout, std::cerr); });
}
