#include <CLI/CLI.hpp>
#include <iostream>

#include "modules/runtime/program.h"
#include "studies/plan/plan_command.h"

int main(int argc, char** argv) {
  using namespace palpate;
  CLI::App app(
      "The cheapest model, mesh and step that meet a scene's needs, measured on it here.\n"
      "Run it on a machine that is not busy.",
      "palpate plan");
  plan::PlanOptions options;
  app.add_option("SCENE", options.scene, "Scene file (YAML) with `needs`")->required();
  app.add_option("-o,--out", options.out,
                 "Scene file to write (else SCENE.planned.yaml beside it)");
  app.add_option("--seconds", options.seconds, "Of the scene, from its start")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str();
  return runtime::run_program(app, argc, argv,
                              [&] { return plan::run_plan(options, std::cout, std::cerr); });
}
