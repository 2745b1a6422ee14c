#include <iostream>

#include "bench/bullet/bullet_command.h"
#include "modules/runtime/program.h"

int main(int argc, char** argv) {
  using namespace palpate;
  runtime::Program program(
      "A ball squeezed between two plates by Bullet's soft body and by ours, in one run.",
      "palpate-bench-bullet");
  bench::BulletOptions options;
  program.add("-o,--out", options.out, "Folder for bullet.csv");
  program.add("--nodes", options.nodes, "Sizes of the ball").range(162, 50000).shows_default();
  program.flag("--quick", options.quick, "Few settings, each timed once");
  return program.run(argc, argv, [&] { return bench::run_bullet(options, std::cout, std::cerr); });
}
