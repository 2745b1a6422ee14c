#include <iostream>
#include <optional>
#include <string>

#include "modules/core/standard_streams.h"
#include "modules/core/stop_signal.h"
#include "modules/runtime/module_options.h"
#include "modules/runtime/program.h"
#include "palpate/run_options.h"
#include "studies/certify/certify_command.h"

int main(int argc, char** argv) {
  using namespace palpate;
  runtime::Program program(
      "Certifies the loop people run on a scene: hand, device, haptics, organ. Each line passes,\n"
      "fails or was not measured.",
      "palpate certify");
  certify::CertifyOptions options;
  program.add_input("SCENE", options.scene, "Scene file (YAML), or the name of a shipped scene")
      .required();
  program.add("-o,--out", options.out, "Folder for certificate.html, certificate.json, tables")
      .shows_default();
  program.add("--depth", options.depth, "Of presses [m]").range(5e-4, 0.05).shows_default();
  program.add("--speed", options.speed, "Of presses in the mean, of slides [m/s]")
      .range(0.005, 0.5)
      .shows_default();
  program
      .add("--push", options.push, "Of held contacts [N]; else what the organ holds at the depth")
      .range(1e-3, 100);
  program.add("--only", options.only, "Parts of the certificate, several with commas; else all")
      .one_of(certify::kParts);
  program.flag("--lockstep", options.lockstep,
               "Only what runs in one process: the same numbers every time");
  program.flag(
      "--quick", options.quick,
      "Fewer disturbances, one row of slides, shorter timing: two minutes or so, in lockstep "
      "under one");
  std::optional<std::string> shard;
  program.add("--shard", shard, std::string(report::kShardHelp) + "; with --lockstep");
  options.bus.session = launcher::random_session_name();
  runtime::add_bus_options(program, options.bus);
  program.footer(
      "Exit code: 0 if no line failed, 1 if one did, 2 for bad input, 130 if it was stopped.");
  return program.run(argc, argv, [&] {
    outlive_readers();
    const StopSignal signal;
    if (shard) options.shard = report::shard_from(*shard);
    return certify::run_certify(
        options, [&] { return signal.requested(); }, std::cout, std::cerr);
  });
}
