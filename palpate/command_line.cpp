#include "palpate/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <functional>
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

using Job = std::function<int()>;

bool no_display() {
  const char* display = std::getenv("DISPLAY");
  return display == nullptr || *display == '\0';
}

void add_view_options(CLI::App& command, RunOptions& options) {
  command.add_flag("--headless", options.headless,
                   "No window; pictures only with --frames (assumed where there is no display)");
  command.add_option("--frames", options.frames, "Folder for a PNG sequence");
  command
      .add_option("--frame-interval-s", options.frame_interval,
                  "Simulated seconds between two pictures of the sequence")
      ->check(CLI::Range(0.001, 3600.0))
      ->capture_default_str();
}

void add_run_options(CLI::App& command, RunOptions& options) {
  runtime::add_bus_options(command, options.bus);
  add_view_options(command, options);
  command.add_option("--duration", options.duration, "Seconds to run; else the scene's duration_s")
      ->check(CLI::Range(0.0, 1e6));
  command.add_option("--record", options.record, "Recording to write (MCAP)");
  command.add_option("--summary", options.summary, "Text file for the summary of the end");
  auto* lockstep = command.add_flag(
      "--lockstep", options.lockstep,
      "Data-driven, without a wall clock, as fast as the machine allows: same bits every time");
  auto* in_process =
      command.add_flag("--in-process", options.in_process, "The same bits in one process");
  in_process->excludes(lockstep)->excludes(command.get_option("--frames"));
  command.add_option("--only", options.only, "Start only these modules, joining a running session")
      ->delimiter(',')
      ->excludes(lockstep)
      ->excludes(in_process);
  command.add_flag_callback(
      "--no-visualizer", [&] { options.visualizer = false; }, "Do not start the visualizer");
  command.add_flag_callback(
      "--no-realtime", [&] { options.realtime = false; }, "Do not ask for real-time priority");
}

void add_run(CLI::App& app, RunOptions& options, Job& job) {
  auto* command = app.add_subcommand("run", "Run a scene: start, watch and stop its processes");
  command->add_option("SCENE", options.scene, "Scene file (YAML)")->required();
  add_run_options(*command, options);
  command->final_callback(
      [&] { job = [&] { return run_command(options, std::cout, std::cerr); }; });
}

void add_replay(CLI::App& app, std::filesystem::path& recording, RunOptions& options, Job& job) {
  auto* command = app.add_subcommand(
      "replay", "Show a recording; with SCENE, run that scene with the recorded probe motion");
  command->add_option("RECORDING", recording, "Recording (MCAP)")->required();
  command->add_option("SCENE", options.scene, "Scene file (YAML)");
  add_run_options(*command, options);
  command->final_callback(
      [&] { job = [&] { return replay_command(recording, options, std::cout, std::cerr); }; });
}

void add_inspect(CLI::App& app, recording::InspectOptions& options, Job& job) {
  auto* command = app.add_subcommand("inspect", "Print what a recording holds");
  command->add_option("RECORDING", options.recording, "Recording (MCAP)")->required();
  command->add_option("--csv", options.csv_folder, "Folder for one CSV file per topic");
  command->final_callback(
      [&] { job = [&] { return recording::run_inspect_command(options, std::cout, std::cerr); }; });
}

void add_diff(CLI::App& app, recording::DiffOptions& options, Job& job) {
  auto* command = app.add_subcommand("diff", "Compare two recordings sample by sample");
  command->add_option("A", options.a, "Recording (MCAP)")->required();
  command->add_option("B", options.b, "Recording (MCAP)")->required();
  command->add_option("--ignore", options.ignore, "Topics, and fields, that may differ")
      ->delimiter(',');
  command->add_option("--csv", options.csv, "File for a row per sample and field that differ");
  command->final_callback(
      [&] { job = [&] { return recording::run_diff_command(options, std::cout, std::cerr); }; });
}

void add_check(CLI::App& app, std::filesystem::path& scene, double& measure_for, Job& job) {
  auto* command = app.add_subcommand("check", "Print what a scene holds and what it costs here");
  command->add_option("SCENE", scene, "Scene file (YAML)")->required();
  command->add_option("--measure-s", measure_for, "Seconds to measure the cost of a step for")
      ->check(CLI::Range(0.01, 600.0))
      ->capture_default_str();
  command->final_callback(
      [&] { job = [&] { return check_command(scene, measure_for, std::cout); }; });
}

void add_mesh(CLI::App& app, geometry::MeshCommandOptions& options, Job& job) {
  auto* command = app.add_subcommand("mesh", "Check, repair, decimate or refine a surface mesh");
  command->add_option("IN", options.input, "Any surface format assimp reads")->required();
  command->add_option("-o,--output", options.output, "ply, stl, obj or off file, in metres");
  command->add_option("--nodes", options.node_count, "Decimate or refine to this many nodes")
      ->check(CLI::Range(4, 200000));
  command->add_option("--unit", options.unit, "Unit of the input: m, dm, cm, mm, um, in")
      ->capture_default_str();
  command->final_callback(
      [&] { job = [&] { return geometry::run_mesh_command(options, std::cout, std::cerr); }; });
}

/// What follows the word belongs to the program, --help too.
void add_study(CLI::App& app, const Study& study, Job& job) {
  auto* command = app.add_subcommand(study.word, study.meaning);
  command->prefix_command();
  command->set_help_flag();
  command->final_callback([&job, command, program = std::string("palpate-") + study.word] {
    job = [words = command->remaining(), program]() -> int {
      become(program_folder() / program, words);
    };
  });
}

/// Says so where `word` is meant as a command and is none.
bool refuse_unknown(const std::string& word, const CLI::App& app) {
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  const auto is_it = [&](const CLI::App* command) { return command->get_name() == word; };
  if (word.starts_with('-') || std::any_of(commands.begin(), commands.end(), is_it)) return false;
  std::cerr << "palpate: there is no command '" << word << "'; there are";
  for (const auto* command : commands) std::cerr << ' ' << command->get_name();
  std::cerr << '\n';
  return true;
}

}  // namespace

int palpate_command(int argc, char** argv) {
  CLI::App app("Press a soft organ and feel it.", "palpate");
  app.require_subcommand(1);
  RunOptions run;
  run.bus.session = random_session_name();
  RunOptions replay = run;
  std::filesystem::path recording, scene;
  recording::InspectOptions inspect;
  recording::DiffOptions diff;
  geometry::MeshCommandOptions mesh;
  double measure_for = 1;
  Job job;
  add_run(app, run, job);
  add_replay(app, recording, replay, job);
  add_inspect(app, inspect, job);
  add_diff(app, diff, job);
  add_check(app, scene, measure_for, job);
  add_mesh(app, mesh, job);
  for (const Study& study : studies()) add_study(app, study, job);
  if (argc > 1 && refuse_unknown(argv[1], app)) return kExitBadInput;
  return runtime::run_program(app, argc, argv, [&] {
    if (no_display()) run.headless = replay.headless = true;
    return job();
  });
}

}  // namespace palpate::launcher
