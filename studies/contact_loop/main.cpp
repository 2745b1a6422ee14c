#include <CLI/CLI.hpp>
#include <iostream>

#include "modules/runtime/program.h"
#include "modules/runtime/stop_signal.h"
#include "studies/contact_loop/contact_loop_command.h"

int main(int argc, char** argv) {
  using namespace palpate;
  CLI::App app("Balls that go in and out of organs: searches inside an organ without a contact.",
               "palpate contact-loop");
  contact_loop::ContactLoopOptions options;
  app.add_option("--scene", options.scenes, "Only these scene files (YAML)");
  app.add_option("--radius", options.radii, "Of the ball [m]")->check(CLI::Range(1e-4, 0.05));
  app.add_option("--speed", options.speeds, "Largest [m/s]")->check(CLI::Range(1e-3, 2.9));
  app.add_option("--rate", options.rates, "Of deformation [Hz]")->check(CLI::Range(1.0, 1000.0));
  app.add_flag("--quick", options.quick, "A few balls: about a minute");
  return runtime::run_program(app, argc, argv, [&] {
    const runtime::StopSignal signal;
    return contact_loop::run_contact_loop(
        options, [&] { return signal.requested(); }, std::cout);
  });
}
