#include "palpate/replay_command.h"

#include <memory>
#include <optional>
#include <ostream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/core/temporary_folder.h"
#include "modules/recording/commands.h"
#include "modules/recording/player.h"
#include "modules/recording/sample_reader.h"
#include "modules/runtime/stop_signal.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/settings.h"
#include "palpate/module_group.h"
#include "palpate/rerun.h"
#include "palpate/run_command.h"
#include "palpate/session_claim.h"

namespace palpate::launcher {
namespace {

/// The resolved text of the scene that was recorded.
std::string recorded_scene(const std::filesystem::path& recording) {
  recording::SampleReader reader(recording);
  while (const auto sample = reader.next()) {
    messages::AnyMessage message;
    if (sample->topic->name != bus::kScene.name) continue;
    if (sample->topic->type->decode(sample->payload, message) != nullptr) continue;
    if (const auto* scene = std::get_if<SceneDescription>(&message)) return scene->resolved_text;
  }
  throw InputError(recording.string() + ": holds no scene: it began after the session or is torn");
}

int show(const std::filesystem::path& recording, const Playing& playing, const RunOptions& run,
         std::ostream& out, std::ostream& log) {
  // Samples of then among those of now would move a running session's organs.
  const SessionClaim claim(run.bus.session, run.bus.domain);
  const runtime::StopSignal stop;
  const TemporaryFolder folder;
  RunOptions viewing = run;
  viewing.scene = folder.write("scene.yaml", recorded_scene(recording));
  viewing.only = {"visualizer"};
  viewing.record.clear();
  const auto commands = module_commands(viewing, program_folder());
  check_keys_of(commands);
  ModuleGroup visualizer(commands, log);
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

/// The scene with the probes of the recording moving as they moved.
scene::Scene with_recorded_motion(scene::Scene scene, const std::filesystem::path& recording,
                                  const std::filesystem::path& folder, std::ostream& log) {
  std::vector<std::string> warnings;
  const auto trajectories = recording::extract_probe_trajectories(recording, folder, warnings);
  for (const auto& warning : warnings) log << "palpate: " << warning << '\n';
  for (const auto& trajectory : trajectories) {
    if (trajectory.probe >= scene.probes.size()) {
      throw InputError(recording.string() + ": moves probe " + std::to_string(trajectory.probe) +
                       ", the scene has only " + std::to_string(scene.probes.size()));
    }
    scene.probes[trajectory.probe].device = scene::TrajectoryDevice{.file = trajectory.file};
  }
  return scene;
}

}  // namespace

int replay_command(const std::filesystem::path& recording, const Playing& playing,
                   const RunOptions& run, std::ostream& out, std::ostream& log) {
  if (run.scene.empty() && playing.rerun.empty()) return show(recording, playing, run, out, log);
  if (playing.start > 0 || playing.rate != 1 || playing.step) {
    throw InputError(
        "--start, --rate and --step: of a replay without SCENE and --rerun; with them all is "
        "computed anew");
  }
  const runtime::StopSignal stop;  // or a signal would leave the folder
  const TemporaryFolder folder;
  RunOptions again = run;
  if (!playing.rerun.empty()) {
    if (run.scene.empty()) again.scene = folder.write("recorded.yaml", recorded_scene(recording));
    const scene::Scene scene = scene::load_scene_with(again.scene, run.settings);
    again.scene = folder.write("scene.yaml", scene::resolved_text(scene));
    return rerun(recording, playing.rerun, again, out, log);
  }
  const scene::Scene scene = with_recorded_motion(scene::load_scene_with(run.scene, run.settings),
                                                  recording, folder.path(), log);
  again.settings.clear();
  again.scene = folder.write("scene.yaml", scene::resolved_text(scene));
  return run_command(again, out, log);
}

}  // namespace palpate::launcher
