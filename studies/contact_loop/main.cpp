#include <iostream>

#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/runtime/program.h"
#include "studies/contact_loop/contact_loop_command.h"

int main(int argc, char** argv) {
  using namespace palpate;
  runtime::Program program(
      "Balls and other tools that go in and out of organs: searches inside an organ without a "
      "contact.",
      "palpate contact-loop");
  contact_loop::ContactLoopOptions options;
  program.add("--scene", options.scenes, "Only these scenes: files, or names as of `palpate run`");
  program.add("--tool", options.tools,
              "Only these: ball, needle, rod, wire, box, blade, mesh, cone, grasper");
  program.add("--radius", options.radii, "Of the ball [m]").range(1e-4, 0.05);
  program.add("--speed", options.speeds, "Largest [m/s]").range(1e-3, 2.9);
  program.add("--rate", options.rates, "Of deformation [Hz]").range(1.0, 2000.0);
  program.add("--collision-rate", options.collision_rates, "Of searches [Hz]").range(1.0, 2000.0);
  program
      .add("--loss", options.loss,
           "Share of contacts and node positions that never arrive, as where processes are late")
      .range(0.0, 0.9);
  program.add("--places", options.places, "On the organ's front; from the second on at random")
      .range(1, 1000);
  program.flag("--quick", options.quick, "A few balls: about a minute");
  program.footer(
      "Exit code: 0 if no search found a tool inside an organ without contact, none left contacts "
      "out, no wall was crossed and no step left tissue in a round tool and did not say so, 1 if "
      "one did, 2 for bad input, 130 if it was stopped.");
  return program.run(argc, argv, [&] {
    const StopSignal signal;
    return contact_loop::run_contact_loop(
        options,
        [&] {
          if (signal.requested()) throw Interrupted("stopped");
        },
        std::cout);
  });
}
