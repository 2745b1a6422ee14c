#include "palpate/replay_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <optional>
#include <ostream>
#include <set>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/core/temporary_folder.h"
#include "modules/recording/commands.h"
#include "modules/recording/player.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/placed_files.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/settings.h"
#include "palpate/known_names.h"
#include "palpate/module_group.h"
#include "palpate/recorded_scene.h"
#include "palpate/rerun.h"
#include "palpate/run_command.h"
#include "palpate/session_claim.h"
#include "palpate/unpacked_scene.h"

namespace palpate::launcher {
namespace {

int show(const std::filesystem::path& recording, const Playing& playing, const RunOptions& run,
         std::ostream& out, std::ostream& log) {
  if (std::getenv("PALPATE_KEYS") != nullptr) {
    throw InputError(
        "--secure, or PALPATE_KEYS: no key lets one process say what all have said; a recording is "
        "shown without, in a session of its own");
  }
  check_frames(run);
  recording::check_start(recording, playing.start);  // before anybody is started to look at it
  // Samples of then among those of now would move a running session's organs.
  const SessionClaim claim(run.bus.session, run.bus.domain,
                           {runtime::kModules.begin(), runtime::kModules.end()});
  const StopSignal stop;
  const TemporaryFolder folder;
  RunOptions viewing = run;
  viewing.scene = UnpackedScene(recording, folder.path(), log).file();
  viewing.only = {"visualizer"};
  viewing.record.clear();
  const auto commands = module_commands(viewing, program_folder());
  clear_frames(run);
  ModuleGroup visualizer(commands, log, Restarting::kNever, folder.path());
  const bool shown = visualizer.any_running();
  if (!shown) log << "palpate: playing into session " << run.bus.session << std::endl;

  const auto stop_requested = [&] {
    visualizer.poll();
    return stop.requested() || (shown && !visualizer.any_running());
  };
  recording::ReplayOptions options{recording, run.bus};
  options.start = playing.start;
  options.rate = playing.rate;
  options.step = playing.step;
  const int code = recording::run_replay_command(options, stop_requested, out, log);
  visualizer.stop();
  return code;
}

std::string listed(const std::vector<std::string>& names) {
  return fmt::format("'{}'", fmt::join(names, "', '"));
}

/// Of recorded probes, the places in the scene's list of those of the same name; without names, as
/// of a recording that holds no scene, their own.
class ProbeMatch {
 public:
  ProbeMatch(const std::filesystem::path& recording, const scene::Scene& scene, std::ostream& log)
      : recording_(recording) {
    for (const scene::Probe& probe : scene.probes) there_.push_back(probe.name);
    if (const auto told = scene_told_in(recording)) {
      recorded_ = scene::probe_names(told->resolved_text);
      return;
    }
    log << fmt::format(
        "palpate: {}: holds no scene, and so no names of its probes: by their order "
        "they move {}\n",
        recording.string(), listed(there_));
  }

  /// @throws InputError if there is none
  std::size_t place_of(std::size_t recorded) const {
    if (recorded >= recorded_.size()) return place_by_order(recorded);
    const std::string& name = recorded_[recorded];
    const auto found = std::ranges::find(there_, name);
    if (found != there_.end()) return static_cast<std::size_t>(found - there_.begin());
    throw InputError(fmt::format(
        "{}: moves probe {}, which the scene has not: recorded were {}, the scene has {}; name the "
        "one that is to move so like it, for the first: --set probes[0].name={}",
        recording_.string(), listed({name}), listed(recorded_), listed(there_), name));
  }

 private:
  std::size_t place_by_order(std::size_t recorded) const {
    if (recorded_.empty() && recorded < there_.size()) return recorded;
    throw InputError(fmt::format(
        "{}: moves a probe number {}, of which it has no name; the scene has {}: give one with as "
        "many probes",
        recording_.string(), recorded, listed(there_)));
  }

  const std::filesystem::path& recording_;
  std::vector<std::string> recorded_, there_;
};

/// The scene with the probes of the recording moving as they moved.
scene::Scene with_recorded_motion(scene::Scene scene, const std::filesystem::path& recording,
                                  const std::filesystem::path& folder, KnownNames& names,
                                  std::ostream& log) {
  std::vector<std::string> warnings;
  const auto trajectories = recording::extract_probe_trajectories(recording, folder, warnings);
  for (const auto& warning : warnings) log << "palpate: " << warning << '\n';
  const ProbeMatch match(recording, scene, log);
  for (const auto& trajectory : trajectories) {
    names.add(trajectory.file, recording.string() + ", probe " + std::to_string(trajectory.probe));
    scene.probes[match.place_of(trajectory.probe)].device =
        scene::TrajectoryDevice{.file = trajectory.file};
  }
  return scene;
}

}  // namespace

void check_replay_options(const std::vector<std::string>& given, const Playing& playing,
                          const RunOptions& run) {
  static const std::set<std::string> kShowing{
      "--start",       "--rate",   "--step",     "--session",          "--domain",
      "--secure",      "--frames", "--headless", "--frame-interval-s", "--no-visualizer",
      "--no-realtime", "--close"};
  static const std::set<std::string> kRerun{"--rerun",  "--set",       "--duration",
                                            "--record", "--overwrite", "--record-topics",
                                            "--domain"};  // the last by the environment
  const bool rerun = !playing.rerun.empty();
  if (!rerun && !run.scene.empty()) return;
  for (const std::string& option : given) {
    if ((rerun ? kRerun : kShowing).contains(option)) continue;
    if (!rerun && option == "--overwrite" && !run.frames.empty()) continue;  // pictures
    throw InputError(option + (rerun ? ": does not go together with --rerun"
                                     : ": of a replay with SCENE; without, the recording is shown "
                                       "as it was"));
  }
}

int replay_command(const std::filesystem::path& recording, const Playing& playing,
                   const RunOptions& run, std::ostream& out, std::ostream& log) {
  if (run.scene.empty() && playing.rerun.empty()) return show(recording, playing, run, out, log);
  if (playing.start > 0 || playing.rate != 1 || playing.step) {
    throw InputError(
        "--start, --rate and --step: of a replay without SCENE and --rerun; with them all is "
        "computed anew");
  }
  const StopSignal stop;  // or a signal would leave the folder
  const TemporaryFolder folder;
  RunOptions again = run;
  KnownNames names;
  std::string known = run.scene.empty() ? "the scene of " + recording.string() : run.scene.string();
  for (const std::string& setting : run.settings) known += " with --set " + setting;
  if (!playing.rerun.empty()) {
    const UnpackedScene recorded(recording, folder.path(), log);
    if (run.scene.empty()) again.scene = recorded.file();
    const scene::Scene scene = scene::load_scene_with(again.scene, run.settings);
    again.scene = folder.write("scene.yaml", scene::resolved_text(scene));
    names.add(again.scene, known);
    try {
      return rerun(recording, playing.rerun, again, recorded, !run.scene.empty(), out, log);
    } catch (const InputError& error) {
      throw names.in(error);
    }
  }
  const scene::Scene scene = with_recorded_motion(scene::load_scene_with(run.scene, run.settings),
                                                  recording, folder.path(), names, log);
  again.settings.clear();
  again.folder = folder.path();
  again.scene = folder.write("scene.yaml", scene::resolved_text(scene));
  const KnownNames motions = names;  // a command that is told needs the scene where it is
  NamingStream named_log(log, motions);
  names.add(again.scene, known);
  try {
    return run_command(again, out, named_log);
  } catch (const InputError& error) {
    throw names.in(error);
  }
}

}  // namespace palpate::launcher
