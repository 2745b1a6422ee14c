#include <CLI/CLI.hpp>
#include <iostream>

#include "modules/runtime/program.h"
#include "studies/paper/paper_command.h"

int main(int argc, char** argv) {
  using namespace palpate;
  CLI::App app("The figures and numbers of Hong et al., made anew: CSV files and pictures.",
               "palpate paper");
  paper::PaperOptions options;
  app.add_option("-o,--out", options.out, "Folder to write to")->capture_default_str();
  app.add_option("--only", options.only, "Only these: figures 1 to 4, speed")
      ->delimiter(',')
      ->check(CLI::IsMember(paper::paper_parts()));
  app.add_flag("--quick", options.quick, "Short runs, Figure 4 on 550 nodes: under a minute");
  app.add_option("--budget-s", options.budget,
                 "Wall time after which Figure 4 is cut short, and says so")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  return runtime::run_program(app, argc, argv,
                              [&] { return paper::run_paper(options, std::cout, std::cerr); });
}
