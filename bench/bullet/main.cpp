#include <CLI/CLI.hpp>
#include <iostream>

#include "bench/bullet/bullet_command.h"
#include "modules/runtime/program.h"

int main(int argc, char** argv) {
  using namespace palpate;
  CLI::App app("A ball squeezed between two plates by Bullet's soft body and by ours, in one run.",
               "palpate-bench-bullet");
  bench::BulletOptions options;
  app.add_option("-o,--out", options.out, "Folder for bullet.csv");
  app.add_option("--nodes", options.nodes, "Sizes of the ball")
      ->delimiter(',')
      ->check(CLI::Range(162, 50000))
      ->capture_default_str();
  app.add_flag("--quick", options.quick, "Few settings, each timed once");
  return runtime::run_program(app, argc, argv,
                              [&] { return bench::run_bullet(options, std::cout, std::cerr); });
}
