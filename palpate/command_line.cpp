#include "palpate/command_line.h"

#include <spdlog/fmt/fmt.h>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "modules/bus/keys.h"
#include "modules/bus/session_token.h"
#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/core/standard_streams.h"
#include "modules/recording/commands.h"
#include "modules/runtime/module_options.h"
#include "modules/runtime/program.h"
#include "modules/scene/scene_file.h"
#include "palpate/check_command.h"
#include "palpate/completion.h"
#include "palpate/list_command.h"
#include "palpate/mesh_command.h"
#include "palpate/new_command.h"
#include "palpate/replay_command.h"
#include "palpate/run_command.h"
#include "palpate/study_command.h"

namespace palpate::launcher {
namespace {

using runtime::Option;
using runtime::Options;
using runtime::Program;

/// Whether a local display answers: a window that never comes would be waited for.
bool answers(int display) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string path = "/tmp/.X11-unix/X" + std::to_string(display);
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool connected =
      ::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(socket);
  return connected;
}

bool no_display() {
  const char* named = std::getenv("DISPLAY");
  const std::string display = named == nullptr ? "" : named;
  const auto colon = display.find(':');
  if (colon == std::string::npos) return true;
  if (colon > 0 && !display.starts_with("unix:")) return false;  // another host's
  return !answers(std::atoi(display.c_str() + colon + 1));
}

constexpr const char* kFirstScene = "press_me";
constexpr const char* kSceneHelp = "Scene file (YAML), or the name of a shipped scene";

void add_settings(Options& command, std::vector<std::string>& settings) {
  command.add_each("--set", settings,
                   "Another value for a key of the scene: "
                   "--set organs[0].tissue.youngs_modulus_pa=8e3; may be given again");
}

void add_view_options(Options& command, RunOptions& options, const Option& frames) {
  command.flag("--headless", options.headless,
               "No window; pictures only with --frames (assumed where there is no display)");
  command
      .add("--frame-interval-s", options.frame_interval,
           "Simulated seconds between two pictures of the sequence")
      .range(0.001, 3600.0)
      .shows_default()
      .needs(frames);
}

void add_run_options(Options& command, RunOptions& options) {
  add_settings(command, options.settings);
  const Option session = runtime::add_bus_options(command, options.bus);
  const Option frames = command.add("--frames", options.frames,
                                    "Folder for a PNG sequence; pictures of an earlier run are "
                                    "replaced only with --overwrite");
  add_view_options(command, options, frames);
  command.add("--duration", options.duration, "Seconds to run; else the scene's duration_s")
      .range(0.001, 1e6);
  command.add_output("--record", options.record,
                     "Recording to write (MCAP); one that is there is replaced only with "
                     "--overwrite");
  command.flag("--overwrite", options.overwrite,
               "Replace the recording, snapshot or pictures that are there");
  command.add("--record-topics", options.record_topics,
              "What it holds: all, TOPIC, or TOPIC=HZ for at most so many a second; else all in "
              "lockstep, and in real time all,node_positions=20,contact_model=10,contacts=20");
  command.add_output("--summary", options.summary, "Text file for the summary of the end");
  const Option lockstep = command.flag(
      "--lockstep", options.lockstep,
      "Data-driven, without a wall clock, as fast as the machine allows: same bits every time");
  const Option in_process =
      command.flag("--in-process", options.in_process, "The same bits in one process")
          .excludes(lockstep)
          .excludes(frames)
          .excludes(session);
  command.add_input("--from-snapshot", options.from_snapshot,
                    "Go on from a snapshot of the same scene, to the bit; with --lockstep or "
                    "--in-process");
  command
      .add("--snapshot-at", options.snapshot_at,
           "Simulated seconds at which a snapshot is written, at the next cycle; the same")
      .range(1e-6, 1e6);
  command.add_output("--snapshot", options.snapshot, "File for it");
  command.add("--only", options.only, "Start only these modules, joining a running session")
      .excludes(lockstep)
      .excludes(in_process);
  command
      .add_input("--secure", options.secure,
                 "Folder of keys (palpate keys): who has none of them neither reads nor writes")
      .excludes(in_process);
  command
      .add_input("--hosts", options.hosts,
                 "File that says which host runs which modules, the same on all; with --host")
      .excludes(in_process);
  command.add("--host", options.host, "Which of the hosts of --hosts this one is");
  command.flag("--close", options.close, "Close the window when the run ends; else it stays")
      .excludes(in_process);
  command.flag_off("--no-visualizer", options.visualizer, "Do not start the visualizer")
      .excludes(frames);
  command.flag_off("--no-realtime", options.realtime, "Do not ask for real-time priority");
  command
      .flag_off("--no-restart", options.restart,
                "Leave processes that die or hang as they are; else they are started again")
      .excludes(lockstep)
      .excludes(in_process);
  command.footer(
      "Exit code: 0 if it ran to its end or was stopped, 1 if something failed, or it was stopped "
      "before its snapshot, 2 for bad input, 130 if it was stopped before, while an organ "
      "was resampled or filled.");
}

/// By the environment: each process of the session inherits it.
void use_keys(const std::filesystem::path& folder) {
  if (folder.empty()) return;
  ::setenv("PALPATE_KEYS", std::filesystem::absolute(folder).c_str(), 1);
}

/// The environment may give one to whoever uses it.
void check_domain(const Program& program, const RunOptions& options) {
  if (!options.in_process || std::getenv("PALPATE_DOMAIN") != nullptr) return;
  for (const std::string& option : program.given()) {
    if (option == "--domain") throw InputError("--in-process excludes --domain");
  }
}

void add_run(Program& program, RunOptions& options) {
  Options command = program.command("run", "Run a scene: start, watch and stop its processes",
                                    [&program, &options] {
                                      outlive_readers();
                                      check_domain(program, options);
                                      use_keys(options.secure);
                                      options.headless |= no_display();
                                      options.scene = scene::scene_file(options.scene);
                                      return run_command(options, std::cout, std::cerr);
                                    });
  options.scene = kFirstScene;
  command.add_input("SCENE", options.scene, kSceneHelp).shows_default();
  add_run_options(command, options);
}

void add_replay(Program& program, std::filesystem::path& recording, Playing& playing,
                RunOptions& options) {
  Options command = program.command(
      "replay", "Show a recording; with SCENE, run that scene with the recorded probe motion",
      [&program, &recording, &playing, &options] {
        outlive_readers();
        check_replay_options(program.given(), playing, options);
        check_domain(program, options);
        use_keys(options.secure);
        options.headless |= no_display();
        options.scene = scene::scene_file(options.scene);
        return replay_command(recording, playing, options, std::cout, std::cerr);
      });
  command.add_input("RECORDING", recording, "Recording (MCAP)").required();
  command.add_input("SCENE", options.scene, kSceneHelp);
  command.add("--start", playing.start, "Seconds of the recording to leave out").range(0.0, 1e6);
  command.add("--rate", playing.rate, "Times as fast as it was").range(0.01, 100.0).shows_default();
  command.flag("--step", playing.step, "A picture for each press of Enter");
  command.add("--rerun", playing.rerun,
              "Compute these stages anew, in one process, on what the recording has of the others: "
              "haptics, collision, deformation; with --record");
  add_run_options(command, options);
}

void add_inspect(Program& program, recording::InspectOptions& options) {
  Options command = program.command("inspect", "Print what a recording holds", [&options] {
    return recording::run_inspect_command(options, std::cout, std::cerr);
  });
  command.add("RECORDING", options.recording, "Recording (MCAP)").required();
  const Option csv =
      command.add("--csv", options.csv_folder, "Folder for one CSV file per topic and key");
  command
      .flag("--overwrite", options.overwrite,
            "Replace the CSV files that another recording left in that folder")
      .needs(csv);
  command.add_output("--repair", options.repaired,
                     "File for what can be read of a torn or damaged recording; with its indexes");
  command.add_output("--foxglove", options.foxglove,
                     "File with the same samples and, beside them, what Foxglove's panels show: "
                     "surfaces, probes, forces");
  command.flag("--json", options.json, "Print JSON");
}

void add_diff(Program& program, recording::DiffOptions& options) {
  Options command = program.command("diff", "Compare two recordings sample by sample", [&options] {
    const int code = recording::run_diff_command(options, std::cout, std::cerr);
    return why_output_is_lost().empty() ? code : kExitBadInput;  // 1 says that they differ
  });
  command.add_input("A", options.a, "Recording (MCAP)").required();
  command.add_input("B", options.b, "Recording (MCAP)").required();
  command.add("--ignore", options.ignore, "Topics, and fields, that may differ");
  command.add_output("--csv", options.csv, "File for a row per sample and field that differ");
  command.footer("Exit code: 0 if they are equal, 1 if they differ, 2 if they cannot be compared.");
}

void add_check(Program& program, CheckOptions& options) {
  Options command = program.command("check", "Print what a scene holds and what it costs here",
                                    [&] { return check_command(options, std::cout, std::cerr); });
  command.add("SCENE", options.scene, kSceneHelp).required();
  add_settings(command, options.settings);
  command.add("--measure-s", options.measure_for, "Seconds to measure the cost of a step for")
      .range(0.01, 600.0)
      .shows_default();
  const Option resolved =
      command.flag("--resolved", options.resolved, "Print the scene with every default instead");
  command.flag("--json", options.json, "Print JSON").excludes(resolved);
}

void add_list(Program& program, std::string& kind) {
  Options command =
      program.command("list", "Print the scenes, models, shapes and devices there are",
                      [&kind] { return list_command(kind, std::cout); });
  command.add("KIND", kind, "One of them").one_of(list_kinds());
}

void add_new(Program& program, NewOptions& options) {
  Options command = program.command("new", "Make a scene from a mesh",
                                    [&options] { return new_command(options, std::cout); });
  command.add_input("MESH", options.mesh, "Any surface format assimp reads").required();
  command.add_output("-o,--output", options.output, "Scene to write; else the mesh's name, here");
  command.add("--unit", options.unit, "Unit of the mesh: m, dm, cm, mm, um, in; else guessed");
}

struct KeyOptions {
  std::filesystem::path folder;
  double days = 30;
};

void add_keys(Program& program, KeyOptions& options) {
  Options command = program.command("keys", "Make the keys of a session (run --secure)", [&] {
    constexpr double kSecondsPerDay = 86'400;
    bus::make_keys(options.folder,
                   std::chrono::seconds(std::int64_t(kSecondsPerDay * options.days)));
    std::cout << fmt::format("{}: keys of every role, for {:g} days\n", options.folder.string(),
                             options.days);
    return kExitDone;
  });
  command.add_output("DIR", options.folder, "A new folder").required();
  command.add("--days", options.days, "Until they expire").range(0.01, 3650.0).shows_default();
}

void add_token(Program& program, bus::BusOptions& session) {
  Options command = program.command(
      "token", "Print what samples of a session bear, for drivers over another DDS", [&session] {
        std::cout << bus::token_text(bus::session_token(session.domain, session.session)) << '\n';
        return kExitDone;
      });
  runtime::add_bus_options(command, session);
}

void add_near(Options& command, geometry::NearMotion& near) {
  const Option file = command.add_input(
      "--near", near.file,
      "Recorded motion (table, bag of ROS 1, or of ROS 2 in MCAP): fill the surface with "
      "tetrahedra, small where a sphere that moves so touches it");
  const auto add = [&](const char* name, auto& value, const char* help) {
    return command.add(name, value, help).needs(file);
  };
  add("--radius-m", near.radius, "Of that sphere").range(1e-4, 0.5);
  add("--near-columns", near.columns,
      "Of a table: names or numbers of time, x, y, z; else by its header");
  add("--near-topic", near.topic, "Of a bag: the topic with its poses, where it has several");
  add("--near-unit", near.unit, "Unit of the motion's positions").shows_default();
  add("--near-position-m", near.position, "Of the motion's origin in the mesh's frame");
  add("--near-rotation-xyzw", near.rotation, "Unit quaternion, of the motion's frame");
  add("--edge-m", near.edge, "Longest edge there; else half the radius").range(1e-4, 1);
  add("--growth", near.growth, "How much longer edges may be per metre; else 0.5").range(0.05, 100);
}

void add_mesh(Program& program, geometry::MeshCommandOptions& options) {
  Options command = program.command("mesh", "Check, repair, decimate or refine a mesh", [&options] {
    return geometry::run_mesh_command(options, std::cout, std::cerr);
  });
  command
      .add_input("IN", options.input,
                 "A surface in any format assimp reads; with --near also tetrahedra (.msh, .vtk)")
      .required();
  command.add_output("-o,--output", options.output,
                     ".ply, .stl, .obj or .off, or with --near tetrahedra as .msh; in metres");
  command
      .add("--nodes", options.node_count,
           "Decimate or refine the surface to this many nodes, with --near before it is filled")
      .range(4, 200000);
  command.add("--unit", options.unit, "Unit of the input: m, dm, cm, mm, um, in").shows_default();
  command.flag("--largest", options.largest, "Keep only the shell that encloses most");
  command.flag("--fill-holes", options.fill_holes, "Close what is open");
  command.flag("--overwrite", options.overwrite, "Replace a file that is there already");
  add_near(command, options.near);
  command.flag("--json", options.json, "Print JSON");
}

/// For bash, and for zsh behind bashcompinit: asks this program itself.
constexpr const char* kCompletion = R"(_palpate() {
  local words
  words=$(palpate completion "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
  COMPREPLY=($(compgen -W "$words" -- "${COMP_WORDS[COMP_CWORD]}"))
}
complete -o default -F _palpate palpate
)";

constexpr const char* kCompletionMeaning = "Words for the shell: source <(palpate completion)";

/// Without words the script, with them what may stand in the place of the last.
int completion(const Program& program, const std::vector<std::string>& words) {
  if (words == std::vector<std::string>{"--help"}) {
    std::cout << kCompletionMeaning << "\n\n" << runtime::kExitCodes << '\n';
    return kExitDone;
  }
  if (words.empty() || words == std::vector<std::string>{"bash"}) {
    std::cout << kCompletion;
    return kExitDone;
  }
  const std::vector<std::string> commands = program.commands();
  std::vector<std::string> offered;
  if (words.size() == 1 || words.front() == "help") {
    offered = commands;
  } else if (std::ranges::find(commands, words.front()) != commands.end()) {
    std::vector<std::string> scenes;
    for (const auto& scene : scene::shipped_scenes()) scenes.push_back(scene.name);
    offered =
        completions(words_in(help_of(words.front())), {words.begin() + 1, words.end()}, scenes);
  }
  for (const auto& word : offered) std::cout << word << '\n';
  return kExitDone;
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
  RunOptions replay = run;
  std::filesystem::path recording;
  Playing playing;
  CheckOptions check;
  std::string kind;
  NewOptions fresh;
  recording::InspectOptions inspect;
  recording::DiffOptions diff;
  geometry::MeshCommandOptions mesh;
  bus::BusOptions session;
  KeyOptions keys;
  add_run(program, run);
  add_replay(program, recording, playing, replay);
  add_inspect(program, inspect);
  add_diff(program, diff);
  add_check(program, check);
  add_mesh(program, mesh);
  add_new(program, fresh);
  add_list(program, kind);
  add_token(program, session);
  add_keys(program, keys);
  for (const Study& study : studies()) add_study(program, study);
  program.command_with_words("completion", kCompletionMeaning,
                             [&program](const auto& words) { return completion(program, words); });
  return program.run(argc, argv);
}

}  // namespace palpate::launcher
