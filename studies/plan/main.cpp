#include <iostream>
#include <optional>
#include <string>

#include "modules/runtime/program.h"
#include "studies/plan/plan_command.h"

int main(int argc, char** argv) {
  using namespace palpate;
  runtime::Program program(
      "The cheapest model, mesh and step that meet a scene's needs, measured on it here.\n"
      "Run it on a machine that is not busy.",
      "palpate plan");
  plan::PlanOptions options;
  program
      .add_input("SCENE", options.scene,
                 "Scene file (YAML) with `needs`, or the name of a shipped scene")
      .required();
  program.add_output(
      "-o,--out", options.out,
      "Scene file to write (else SCENE.planned.yaml beside it, of a shipped scene here)");
  program.add("--seconds", options.seconds, "Of the scene, from its start")
      .range(0.1, 600.0)
      .shows_default();
  program.add_each("--set", options.settings,
                   "Another value for a key of the scene: --set needs.force_error=0.1");
  program.add("--touches", options.touches, "Instants at which the truth is computed")
      .range(1, 100)
      .shows_default();
  program.flag("--verify", options.verify,
               "Afterwards judge the choice by a truth on finer meshes, at other instants");
  program.flag("--json", options.json, "Print JSON");
  program.add(
      "--points", options.points,
      "Folder of what was found: shards share it, and a run that was stopped goes on from it");
  std::optional<std::string> shard;
  program.add("--shard", shard,
              "I/N, one of N runs on the same --points: judges candidates that no other run does, "
              "writes no scene; afterwards a run without it does");
  program.footer(
      "Exit code: 0 if a candidate meets the needs, 1 if none does, --verify refuted the choice or "
      "found no truth, 2 for bad input, 130 if it was stopped.");
  return program.run(argc, argv, [&] {
    if (shard) options.shard = report::shard_from(*shard);
    return plan::run_plan(options, std::cout, std::cerr);
  });
}
