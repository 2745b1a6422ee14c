// palpate-recorder: records one session until it is told to stop (Ctrl-C, SIGTERM, SIGHUP).
#include <iostream>
#include <optional>

#include "modules/bus/dds_bus.h"
#include "modules/core/error.h"
#include "modules/core/standard_streams.h"
#include "modules/core/stop_signal.h"
#include "modules/recording/inspect.h"
#include "modules/recording/recorder.h"
#include "modules/recording/recorder_stage.h"
#include "modules/runtime/lockstep_module.h"
#include "modules/runtime/module_options.h"
#include "modules/runtime/periodic_loop.h"
#include "modules/runtime/status_reporter.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/scene_reader.h"

namespace {

using Words = std::vector<std::string>;

constexpr double kPollRateHz = 25;  // a sixth of what the readers can hold at 1 kHz

void record_in_lockstep(const palpate::runtime::ModuleOptions& options,
                        const std::filesystem::path& file, const Words& topics) {
  using namespace palpate;
  if (options.scene.empty()) throw InputError("--lockstep: --scene is missing");
  runtime::start_log("recorder");
  const scene::Scene scene = scene::load_scene(options.scene);
  runtime::run_in_lockstep(options, scene, "recorder", [&](bus::Bus& bus) {
    return std::make_unique<recording::RecorderStage>(bus, file, recording::TopicSelection(topics));
  });
}

/// What is no "info: " is why it ended early, or might.
void say(const std::string& what) {
  if (!what.empty()) std::cerr << "[recorder] " << what << std::endl;
}

/// What its launcher waits for. One that was started by hand says nothing: there may be several.
class Status {
 public:
  Status(palpate::bus::Bus& bus, palpate::recording::Recorder& recorder, const Words& modules)
      : recorder_(recorder), modules_(modules) {
    if (!modules.empty()) reporter_.emplace(bus, "recorder", kPollRateHz, false);
  }
  void poll(const palpate::runtime::PeriodicLoop& loop) {
    using palpate::ModuleState;
    if (!reporter_) return;
    reporter_->set_state(recorder_.hears(modules_) ? ModuleState::kRunning
                                                   : ModuleState::kStarting);
    reporter_->poll(loop.woke_ns(), 0, loop.statistics());
  }

 private:
  palpate::recording::Recorder& recorder_;
  const Words& modules_;
  std::optional<palpate::runtime::StatusReporter> reporter_;
};

void record_in_real_time(const palpate::runtime::ModuleOptions& options,
                         const std::filesystem::path& file, const Words& topics,
                         const Words& hears) {
  const palpate::bus::BusOptions& session = options.bus;
  const palpate::StopSignal stop;
  const palpate::recording::TopicSelection selection(
      topics.empty() ? palpate::recording::kRealTimeTopics : topics);
  palpate::bus::DdsBus bus(
      session, palpate::bus::Arrivals::kGathered);  // first: a bad session leaves no file
  palpate::recording::Recorder recorder(bus, session, file, selection);
  palpate::runtime::PeriodicLoop loop(kPollRateHz);
  Status status(bus, recorder, hears);
  while (!stop.requested() && !recorder.full()) {
    loop.wait_for_period();
    say(recorder.poll());
    status.poll(loop);
  }
  loop.wait_for_period();  // what came before the stop has been gathered then
  const auto cost = recorder.close();
  const std::uint64_t bytes = recorder.file().bytes_written();
  say("info: " + file.string() + ": " + std::to_string(recorder.file().statistics().message_count) +
      " samples, " + std::to_string(bytes) + " bytes, " +
      palpate::recording::cost_text(cost, bytes));
}

void check_module(const std::string& name) {
  if (palpate::runtime::module_named(name)) return;
  throw palpate::InputError("--hears: there is no module '" + name + "'");
}

void record(const palpate::runtime::ModuleOptions& options, const std::filesystem::path& file,
            const Words& topics, const Words& hears) {
  if (!options.lockstep.empty()) return record_in_lockstep(options, file, topics);
  // Its launcher has judged the place; what comes later, when it starts again, is a failure.
  if (hears.empty()) palpate::recording::check_recording_target(file);
  try {
    record_in_real_time(options, file, topics, hears);
  } catch (const palpate::recording::DiskFull& full) {
    say(full.what() + std::string(": the recording ends there, whole; the session goes on"));
  }
}

}  // namespace

int main(int argc, char** argv) {
  palpate::runtime::Program program("Records a session into one MCAP file", "palpate-recorder");
  palpate::runtime::ModuleOptions options;
  options.bus.participant_name = "recorder";
  std::filesystem::path file;
  program.add_output("FILE", file, "The recording to write; one that is there is replaced")
      .required();
  Words topics, hears;
  program.add(
      "--topics", topics,
      "Topics to record: all, NAME, or NAME=HZ for at most so many samples a second; else all in "
      "lockstep, and in real time all,node_positions=20,contact_model=10,contacts=20");
  palpate::runtime::Option hears_option = program.add(
      "--hears", hears,
      "Modules of a session that waits until all of them are heard: a module_status says so");
  palpate::runtime::add_bus_options(program, options.bus);
  const auto lockstep = palpate::runtime::add_lockstep_options(program, options);
  hears_option.excludes(lockstep);
  program
      .add_input("--scene", options.scene,
                 "Scene file; needed in lockstep, which follows its rates")
      .needs(lockstep);
  program.footer(palpate::runtime::kModuleExitCodes);
  return program.run(argc, argv, [&] {
    palpate::outlive_readers();
    for (const auto& module : hears) check_module(module);
    record(options, file, topics, hears);
    return palpate::kExitDone;
  });
}
