#include "palpate/command_line.h"

#include <cstdlib>
#include <iostream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/recording/commands.h"
#include "modules/runtime/module_options.h"
#include "modules/runtime/program.h"
#include "palpate/check_command.h"
#include "palpate/mesh_command.h"
#include "palpate/replay_command.h"
#include "palpate/run_command.h"
#include "palpate/study_command.h"

namespace palpate::launcher {
namespace {

using runtime::Option;
using runtime::Options;
using runtime::Program;

bool no_display() {
  const char* display = std::getenv("DISPLAY");
  return display == nullptr || *display == '\0';
}

void add_view_options(Options& command, RunOptions& options) {
  command.flag("--headless", options.headless,
               "No window; pictures only with --frames (assumed where there is no display)");
  command
      .add("--frame-interval-s", options.frame_interval,
           "Simulated seconds between two pictures of the sequence")
      .range(0.001, 3600.0)
      .shows_default();
}

void add_run_options(Options& command, RunOptions& options) {
  runtime::add_bus_options(command, options.bus);
  const Option frames = command.add("--frames", options.frames, "Folder for a PNG sequence");
  add_view_options(command, options);
  command.add("--duration", options.duration, "Seconds to run; else the scene's duration_s")
      .range(0.0, 1e6);
  command.add_output("--record", options.record, "Recording to write (MCAP)");
  command.add_output("--summary", options.summary, "Text file for the summary of the end");
  const Option lockstep = command.flag(
      "--lockstep", options.lockstep,
      "Data-driven, without a wall clock, as fast as the machine allows: same bits every time");
  const Option in_process =
      command.flag("--in-process", options.in_process, "The same bits in one process")
          .excludes(lockstep)
          .excludes(frames);
  command.add("--only", options.only, "Start only these modules, joining a running session")
      .excludes(lockstep)
      .excludes(in_process);
  command.flag("--close", options.close, "Close the window when the run ends; else it stays");
  command.flag_off("--no-visualizer", options.visualizer, "Do not start the visualizer");
  command.flag_off("--no-realtime", options.realtime, "Do not ask for real-time priority");
}

void add_run(Program& program, RunOptions& options) {
  Options command =
      program.command("run", "Run a scene: start, watch and stop its processes", [&options] {
        options.headless |= no_display();
        return run_command(options, std::cout, std::cerr);
      });
  command.add_input("SCENE", options.scene, "Scene file (YAML)").required();
  add_run_options(command, options);
}

void add_replay(Program& program, std::filesystem::path& recording, RunOptions& options) {
  Options command = program.command(
      "replay", "Show a recording; with SCENE, run that scene with the recorded probe motion",
      [&recording, &options] {
        options.headless |= no_display();
        return replay_command(recording, options, std::cout, std::cerr);
      });
  command.add_input("RECORDING", recording, "Recording (MCAP)").required();
  command.add_input("SCENE", options.scene, "Scene file (YAML)");
  add_run_options(command, options);
}

void add_inspect(Program& program, recording::InspectOptions& options) {
  Options command = program.command("inspect", "Print what a recording holds", [&options] {
    return recording::run_inspect_command(options, std::cout, std::cerr);
  });
  command.add("RECORDING", options.recording, "Recording (MCAP)").required();
  command.add("--csv", options.csv_folder, "Folder for one CSV file per topic");
}

void add_diff(Program& program, recording::DiffOptions& options) {
  Options command = program.command("diff", "Compare two recordings sample by sample", [&options] {
    return recording::run_diff_command(options, std::cout, std::cerr);
  });
  command.add_input("A", options.a, "Recording (MCAP)").required();
  command.add_input("B", options.b, "Recording (MCAP)").required();
  command.add("--ignore", options.ignore, "Topics, and fields, that may differ");
  command.add_output("--csv", options.csv, "File for a row per sample and field that differ");
  command.footer("Exit code: 0 if they are equal, 1 if they differ, 2 if they cannot be compared.");
}

void add_check(Program& program, std::filesystem::path& scene, double& measure_for) {
  Options command = program.command("check", "Print what a scene holds and what it costs here",
                                    [&] { return check_command(scene, measure_for, std::cout); });
  command.add("SCENE", scene, "Scene file (YAML)").required();
  command.add("--measure-s", measure_for, "Seconds to measure the cost of a step for")
      .range(0.01, 600.0)
      .shows_default();
}

void add_mesh(Program& program, geometry::MeshCommandOptions& options) {
  Options command = program.command(
      "mesh", "Check, repair, decimate or refine a surface mesh",
      [&options] { return geometry::run_mesh_command(options, std::cout, std::cerr); });
  command.add_input("IN", options.input, "Any surface format assimp reads").required();
  command.add_output("-o,--output", options.output, "ply, stl, obj or off file, in metres");
  command.add("--nodes", options.node_count, "Decimate or refine to this many nodes")
      .range(4, 200000);
  command.add("--unit", options.unit, "Unit of the input: m, dm, cm, mm, um, in").shows_default();
}

/// What follows the word belongs to the program, --help too.
void add_study(Program& program, const Study& study) {
  program.command_with_words(study.word, study.meaning,
                             [file = program_folder() / (std::string("palpate-") + study.word)](
                                 const auto& words) -> int { become(file, words); });
}

}  // namespace

int palpate_command(int argc, char** argv) {
  Program program("Press a soft organ and feel it.", "palpate");
  RunOptions run;
  run.bus.session = random_session_name();
  RunOptions replay = run;
  std::filesystem::path recording, scene;
  recording::InspectOptions inspect;
  recording::DiffOptions diff;
  geometry::MeshCommandOptions mesh;
  double measure_for = 1;
  add_run(program, run);
  add_replay(program, recording, replay);
  add_inspect(program, inspect);
  add_diff(program, diff);
  add_check(program, scene, measure_for);
  add_mesh(program, mesh);
  for (const Study& study : studies()) add_study(program, study);
  return program.run(argc, argv);
}

}  // namespace palpate::launcher
