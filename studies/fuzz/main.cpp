#include <CLI/CLI.hpp>
#include <iostream>

#include "modules/runtime/program.h"
#include "studies/fuzz/fuzz_command.h"

int main(int argc, char** argv) {
  using namespace palpate;
  CLI::App app("Random scenes, looking for one that fails without a guard noticing.",
               "palpate fuzz");
  fuzz::FuzzOptions options;
  app.add_option("-o,--out", options.out, "Folder for outcomes and failing scenes")
      ->capture_default_str();
  app.add_option("--scenes", options.scenes, "How many")
      ->check(CLI::Range(1, 10'000'000))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Of the scenes")->capture_default_str();
  app.add_option("--scene", options.only, "Only this one, in detail");
  app.add_flag("--again", options.again, "Run anew what earlier runs have left in --out");
  return runtime::run_program(app, argc, argv,
                              [&] { return fuzz::run_fuzz(options, std::cout, std::cerr); });
}
