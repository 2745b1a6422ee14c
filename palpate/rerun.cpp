#include "palpate/rerun.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <ostream>
#include <set>

#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/core/units.h"
#include "modules/messages/message_checks.h"
#include "modules/recording/recorder_stage.h"
#include "modules/recording/sample_reader.h"
#include "modules/recording/session_samples.h"
#include "modules/recording/space_watch.h"
#include "modules/runtime/session.h"
#include "modules/runtime/wiring.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/scene_reader.h"
#include "palpate/recorded_scene.h"
#include "palpate/scene_doubts.h"
#include "palpate/session/in_process.h"
#include "palpate/unpacked_scene.h"

namespace palpate::launcher {
namespace {

/// So far ahead of the session samples are read: in real time they were not recorded in the order
/// of their source times.
constexpr std::int64_t kAheadNs = kNanosecondsPerSecond / 4;

/// What is known of a session once all of its recording is read.
struct Recorded {
  /// When it began in real time, on the clock of source times; 0 of one in lockstep, whose source
  /// times are simulated [ns].
  std::int64_t start_ns = 0;
  std::optional<std::int64_t> first_ns;  ///< earliest of its streams, simulated
  std::set<std::string_view> topics;     ///< that have samples, or were to be recorded
  std::vector<std::string> warnings;
};

/// @throws InputError if it was paused or reset: there is no one time to compute it in
void note_command(const SessionControl& control, const std::filesystem::path& recording,
                  Recorded& recorded) {
  const bool goes_on = recorded.start_ns != 0 && control.command == SessionCommand::kStart &&
                       control.start_time_ns != recorded.start_ns;
  if (goes_on || control.reset_count > 0 || control.command == SessionCommand::kPause) {
    throw InputError(recording.string() +
                     ": its session was paused or reset; --rerun takes one that went on");
  }
  if (control.command == SessionCommand::kStart) recorded.start_ns = control.start_time_ns;
}

Recorded read_through(const std::filesystem::path& recording) {
  recording::SampleReader reader(recording);
  Recorded recorded;
  messages::AnyMessage message;
  runtime::SessionState state;  // of its modules, who did not believe all that was said
  while (const auto sample = reader.next()) {
    recorded.topics.insert(sample->topic->name);
    const runtime::Wire* wire = runtime::find_wire(sample->topic->name);
    if (wire != nullptr && wire->every_cycle) {
      const std::int64_t time_ns = messages::header_of(sample->payload).sim_time_ns;
      recorded.first_ns = std::min(recorded.first_ns.value_or(time_ns), time_ns);
    }
    if (sample->topic->name != bus::kSessionControl.name) continue;
    if (sample->topic->type->decode(sample->payload, message) != nullptr) continue;
    const auto& control = std::get<SessionControl>(message);
    if (!state.believes(control, sample->received_time_ns)) continue;
    state.apply(control);
    note_command(control, recording, recorded);
  }
  for (const bus::TopicInfo& topic : bus::all_topics()) {
    if (reader.selected(std::string(topic.name))) recorded.topics.insert(topic.name);
  }
  recorded.warnings = reader.warnings();
  return recorded;
}

/// @throws InputError if it is not there from the session's start on, or if what the stages read of
///         the others is not there
void check_inputs(const std::filesystem::path& recording, const Recorded& recorded,
                  const std::set<std::string>& stages, const scene::Scene& scene) {
  if (!recorded.first_ns) {
    throw InputError(recording.string() + ": holds no sample of a session's topics");
  }
  const std::int64_t late_ns = recorded.start_ns == 0 ? 0 : kAheadNs;
  if (*recorded.first_ns > late_ns) {
    throw InputError(fmt::format(
        "{}: begins {:g} s after its session, or at a snapshot; --rerun needs all before, too",
        recording.string(), seconds_from_ns(*recorded.first_ns)));
  }
  const bool driven = std::ranges::any_of(scene.probes, [](const scene::Probe& probe) {
    return std::holds_alternative<scene::TopicDevice>(probe.device);
  });
  for (const runtime::Wire& wire : runtime::session_wires()) {
    const bool needed = wire.writer.empty() ? wire.topic == bus::kProbeInput.name && driven
                                            : !stages.contains(std::string(wire.writer));
    if (!needed || recorded.topics.contains(wire.topic)) continue;
    for (const std::string_view reader : wire.readers) {
      if (!stages.contains(std::string(reader))) continue;
      throw InputError(fmt::format("{}: holds no {}, which {} reads (--record-topics all)",
                                   recording.string(), wire.topic, reader));
    }
  }
}

/// Says what others said when they were recorded, on the session's clock.
class RecordedInputs {
 public:
  /// @param stages  that say what they say themselves
  RecordedInputs(const std::filesystem::path& recording, std::int64_t start_ns,
                 const std::set<std::string>& stages, bus::Bus& bus)
      : reader_(recording), session_(bus), start_ns_(start_ns) {
    for (const runtime::Wire& wire : runtime::session_wires()) {
      const bool anew = stages.contains(std::string(wire.writer));
      if (!anew && wire.topic != bus::kScene.name) topics_.insert(wire.topic);
    }
    read_next();
  }

  /// All that was said before `time_ns` and a little more.
  void say_until(std::int64_t time_ns) {
    for (; next_ && said_ns(*next_) < time_ns + kAheadNs; read_next()) say(*next_);
  }
  /// Nothing is left, and the newest sample was said before `time_ns`.
  bool at_end(std::int64_t time_ns) const { return !next_ && newest_ns_ < time_ns; }
  /// Of topics that were read, those of which only some samples are there.
  const std::set<std::string>& thinned() const { return thinned_; }

 private:
  /// Of times beyond what any codec takes nobody hears; the rerun would wait for them for ever.
  void read_next() {
    do {
      next_ = reader_.next();
    } while (next_ && !has_times(*next_));
  }

  /// Strictly within: the difference of two such fits.
  bool has_times(const recording::RecordedSample& sample) const {
    const auto is_time = [](std::int64_t ns) {
      return -messages::kMaxTimeNs < ns && ns < messages::kMaxTimeNs;
    };
    return is_time(messages::header_of(sample.payload).source_time_ns) &&
           is_time(sample.received_time_ns) && is_time(said_ns(sample));
  }

  /// Drivers stamp by any clock, or not at all, and what others say of the future was not said
  /// then: it was when it came.
  std::int64_t said_ns(const recording::RecordedSample& sample) const {
    const std::int64_t source_ns = messages::header_of(sample.payload).source_time_ns;
    const std::int64_t came_ns = sample.received_time_ns;
    const bool future = source_ns > came_ns + kAheadNs;
    const bool unlike =
        sample.topic->name == bus::kProbeInput.name && source_ns < came_ns - kAheadNs;
    const bool has_clock = start_ns_ != 0;  // in lockstep times are simulated, the same for all
    return (has_clock && (future || unlike) ? came_ns : source_ns) - start_ns_;
  }

  void say(recording::RecordedSample& sample) {
    if (runtime::find_wire(sample.topic->name) == nullptr) return;
    const std::int64_t time_ns = said_ns(sample);
    newest_ns_ = std::max(newest_ns_, time_ns);
    if (!topics_.contains(sample.topic->name)) return;
    if (sample.thinned) thinned_.insert(std::string(sample.topic->name));
    const std::int64_t shift_ns = time_ns - messages::header_of(sample.payload).source_time_ns;
    if (start_ns_ != 0) messages::shift_times(*sample.topic->type, shift_ns, sample.payload);
    session_.write(*sample.topic, sample.payload);
  }

  recording::SampleReader reader_;
  recording::SessionWriter session_;
  const std::int64_t start_ns_;  ///< of the session
  std::set<std::string_view> topics_;
  std::optional<recording::RecordedSample> next_;
  std::int64_t newest_ns_ = -1;
  std::set<std::string> thinned_;
};

session::InProcessOptions options_for(const std::set<std::string>& stages, ChunkRunner& runner) {
  session::InProcessOptions options;
  options.runner = &runner;
  options.make = [&stages](std::string_view module, bus::Bus& bus,
                           const session::MakeStage& usual) -> std::unique_ptr<runtime::Stage> {
    const std::string job(runtime::module_named(module).value().job);
    return stages.contains(job) ? usual(bus) : nullptr;
  };
  return options;
}

void check_stages(const std::vector<std::string>& stages, const RunOptions& run) {
  for (const std::string& stage : stages) {
    const bool known = stage == "haptics" || stage == "collision" || stage == "deformation";
    if (known) continue;
    throw InputError("--rerun: there is no stage '" + stage +
                     "'; there are haptics, collision, deformation");
  }
  if (run.record.empty()) throw InputError("--rerun: where to? Give --record FILE, too");
  recording::check_recording_target(run.record);
  if (!run.overwrite && std::filesystem::exists(run.record)) {
    throw InputError(run.record.string() + ": is there already; give another name, or --overwrite");
  }
  recording::check_recording_space(run.record);
}

}  // namespace

int rerun(const std::filesystem::path& recording, const std::vector<std::string>& names,
          const RunOptions& run, const UnpackedScene& recorded_with, bool another_scene,
          std::ostream& out, std::ostream& log) {
  check_stages(names, run);
  const StopSignal stop;
  const std::set<std::string> stages(names.begin(), names.end());
  const scene::Scene scene = scene::load_scene(run.scene);
  const SceneDescription& told = recorded_with.here();
  check_scene_of_rerun(recording, told, scene, stages, another_scene);
  const Recorded recorded = read_through(recording);
  for (const std::string& line : recorded.warnings) log << "palpate: warning: " << line << '\n';
  check_inputs(recording, recorded, stages, scene);
  const std::string anew = fmt::format("{}", fmt::join(stages, ", "));
  runtime::WorkerTeam team(scene.deformation_threads);
  session::InProcess session(scene, session::load_assets(scene, resampling_on(log)),
                             options_for(stages, team));
  auto scenes = session.bus().writer(bus::kScene);
  SceneDescription description = runtime::scene_description(scene);
  description.resolved_text = recorded_with.as_told(description.resolved_text);
  description.header.source_time_ns = runtime::CycleGrid::kSetUp;
  scenes.write(description);
  session.add("recorder", [&](bus::Bus& bus) {
    auto recorder = std::make_unique<recording::RecorderStage>(
        bus, run.record, recording::TopicSelection(run.record_topics));
    recorder->add_metadata({recording::kRerunMetadata,
                            {{"stages", anew},
                             {"recording", recording.filename().string()},
                             {"scene", told.name},
                             {"digest", told.digest}}});
    for (const auto& file : recorded_with.taken()) recorder->add_attachment(file);
    return recorder;
  });
  RecordedInputs inputs(recording, recorded.start_ns, stages, session.bus());
  const std::int64_t end_ns =
      run.duration > 0 ? ns_from_seconds(run.duration) : std::numeric_limits<std::int64_t>::max();
  std::int64_t now_ns = 0;
  for (; !stop.requested(); session.tick()) {
    now_ns = ns_from_seconds(session.time());
    inputs.say_until(now_ns);
    if (inputs.at_end(now_ns) || now_ns >= end_ns) break;
  }
  session.finish(seconds_from_ns(now_ns));
  for (const std::string& topic : inputs.thinned()) {
    log << "palpate: warning: of " << topic
        << " only some samples were recorded (--record-topics all has them all)\n";
  }
  out << fmt::format("scene {}: {} computed anew for {:.10g} s on {}\n", scene.name, anew,
                     seconds_from_ns(now_ns), recording.string());
  if (stop.requested()) {
    log << "palpate: stopped there, the recording goes on\n";
  } else if (now_ns < end_ns && run.duration > 0) {
    log << fmt::format("palpate: the recording ends there, before the {:.10g} s asked for\n",
                       run.duration);
  }
  return kExitDone;
}

}  // namespace palpate::launcher
