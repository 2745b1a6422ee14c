#include <iostream>

#include "modules/core/data_folder.h"
#include "modules/runtime/program.h"
#include "studies/report/progress.h"
#include "studies/volume_methods/measurements.h"
#include "studies/volume_methods/volume_methods_command.h"

int main(int argc, char** argv) {
  using namespace palpate;
  runtime::Program program(
      "Volume methods of the related work side by side: error, cost, largest step, energy.",
      "palpate volume-methods");
  volume_methods::VolumeMethodsOptions options;
  options.scene = data_file("scenes/stomach_probe.yaml");
  std::vector<std::string> names;
  for (const auto& method : volume_methods::compared_methods()) names.push_back(method.name);
  program.add("-o,--out", options.out, "Folder for volume_methods.csv (none: no file)");
  program.add("--only", options.only, "Only these methods").one_of(names);
  program.flag("--quick", options.quick, "Smaller ball, organ pressed for 4 s: under 20 s");
  program.add("--scene", options.scene, "Scene whose first organ is pressed").shows_default();
  program.footer(report::kExitCodesHelp);
  return program.run(argc, argv, [&] {
    return volume_methods::run_volume_methods(options, std::cout, std::cerr);
  });
}
