#include "studies/certify/real_processes.h"

#include <spdlog/fmt/fmt.h>

#include <ostream>

#include "modules/core/data_folder.h"
#include "studies/certify/hands.h"
#include "studies/certify/processes.h"
#include "studies/certify/release.h"
#include "studies/certify/stability.h"
#include "studies/certify/tables.h"
#include "studies/certify/timing.h"

namespace palpate::certify {
namespace {

constexpr double kPressed = 0.3;  // of the push, that the real processes must give
constexpr double kFeltWithin = 60, kPress = 0.5, kCalmFor = 2, kHoldFor = 5.1;  // [s]

scene::EmulatedDevice pressing_hand(const RealRun& run) {
  const Vec3 deep = pose_below(run.subject.place, run.subject.depth).position;
  return firm_hand(run.subject.device, run.subject.place, {{deep, kPress}});
}

/// Starts the session and presses. False, said in a line of `group`, if there is no force.
bool press(const RealRun& run, Processes& processes, const std::string& group,
           const std::function<bool(const Heard&)>& also) {
  const bool ready = processes.start();
  processes.hold(pressing_hand(run));
  const auto feels = [&](const Heard& heard) {
    return heard.force.force.norm() > kPressed * run.push && also(heard);
  };
  if (ready && processes.wait(feels, kFeltWithin)) return true;
  run.add({not_measured(group, "the real processes", "they did not press within a minute")});
  return false;
}

void time_it(const RealRun& run, Processes& processes, const std::string& group) {
  run.log << group << " …" << std::endl;
  const Timing timing = measure_timing(processes, run.options.quick ? 10 : 60);
  if (group == "timing") write_timing(timing, run.options.out);
  run.add(timing_lines(group, timing, 1 / run.subject.scene.rates.haptics));
}

/// From an organ at rest, as in lockstep.
void hold_over_dds(const RealRun& run, Processes& processes) {
  run.log << "held over DDS …" << std::endl;
  const auto never = [](const Heard&) { return false; };
  processes.hold(firm_hand(run.subject.device, run.subject.place, {}));
  processes.wait(never, kCalmFor);
  processes.hold(pushing_hand(run.subject.device, run.subject.place, run.push));
  processes.wait(never, kHoldFor);
  run.add(held_lines("over DDS", processes.heard().held));
}

void release(const RealRun& run, Processes& processes) {
  run.log << "released …" << std::endl;
  processes.hold(pressing_hand(run));
  const auto told = [&](const Release& r) {
    run.log << fmt::format("  {}: let go after {:.1f} ms{}", r.who, 1e3 * r.took,
                           r.back ? "" : ", did not press again")
            << std::endl;
  };
  run.add(release_lines(
      measure_releases(processes, kPressed * run.push, run.options.quick ? 2 : 10, told),
      run.subject.scene));
}

}  // namespace

ContactTroubles measure_real_processes(const RealRun& run) {
  Processes processes(run.subject, run.options.bus, run.options.out, run.keep_going);
  if (press(run, processes, "timing", [](const Heard&) { return true; })) {
    if (run.options.wants("timing")) time_it(run, processes, "timing");
    if (run.options.wants("held")) hold_over_dds(run, processes);
    if (run.options.wants("released")) release(run, processes);
  }
  return processes.contact_troubles();
}

ContactTroubles measure_beside_others(const RealRun& run) {
  const std::string group = "timing with pictures and a CPU hog";
  if (!std::filesystem::exists(program_folder() / "palpate-visualizer")) {
    run.add({not_measured(group, "the real processes", "no visualizer is installed")});
    return {};
  }
  bus::BusOptions bus = run.options.bus;
  bus.session += "_beside";
  Processes processes(run.subject, bus, run.options.out, run.keep_going, Beside::kPicturesAndHog);
  const auto draws = [](const Heard& heard) {
    const auto pictures = heard.modules.find("visualizer");
    return pictures != heard.modules.end() && pictures->second.state >= ModuleState::kRunning;
  };
  if (press(run, processes, group, draws)) time_it(run, processes, group);
  return processes.contact_troubles();
}

}  // namespace palpate::certify
