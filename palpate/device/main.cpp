// palpate-emulated-device: moves one probe of a session as a haptic device in a hand would, until
// the session ends or it is told to stop (Ctrl-C, SIGTERM, SIGHUP).
#include <algorithm>
#include <iostream>
#include <limits>
#include <optional>
#include <stdexcept>

#include "modules/bus/dds_bus.h"
#include "modules/core/error.h"
#include "modules/core/standard_streams.h"
#include "modules/core/stop_signal.h"
#include "modules/core/units.h"
#include "modules/core/whole_file.h"
#include "modules/runtime/module_options.h"
#include "modules/runtime/periodic_loop.h"
#include "modules/runtime/program.h"
#include "modules/runtime/realtime.h"
#include "modules/runtime/session.h"
#include "modules/scene/scene_file.h"
#include "modules/scene/scene_reader.h"
#include "palpate/device/device_log.h"
#include "palpate/device/emulated_driver.h"

namespace {

using namespace palpate;

constexpr const char* kName = "palpate-emulated-device";
constexpr int kFifo = 60;  // below haptics, above collision and deformation
constexpr std::int64_t kWaitingLineEveryNs = 2 * kNanosecondsPerSecond;
constexpr double kShortestWait = 10;  // for a session that starts on a busy machine [s]

struct Options {
  std::filesystem::path scene;
  bus::BusOptions bus;
  std::string probe, device;
  double duration = 0;  // of the hand's, and to wait for it [s]; 0: until the session ends
  std::filesystem::path table;
  bool realtime = true;
};

/// The named probe, or the first one that a driver may move.
std::uint32_t probe_of(const scene::Scene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.probes.size(); ++i) {
    const scene::Probe& probe = scene.probes[i];
    if (!name.empty() && probe.name != name) continue;
    if (std::holds_alternative<scene::TopicDevice>(probe.device)) {
      return static_cast<std::uint32_t>(i);
    }
    if (!name.empty()) {
      throw InputError("probe '" + name + "' of " + scene.file.string() +
                       " is moved by the scene: its device must be topic");
    }
  }
  throw InputError(scene.file.string() + " has no probe " +
                   (name.empty() ? "with device topic" : "'" + name + "'"));
}

/// Says what is waited for.
/// @throws std::runtime_error where that took too long
class Waiting {
 public:
  explicit Waiting(const Options& options)
      : what_("session " + options.bus.session + " in domain " +
              std::to_string(options.bus.domain)),
        longest_ns_(options.duration > 0
                        ? ns_from_seconds(std::max(options.duration, kShortestWait))
                        : std::numeric_limits<std::int64_t>::max()) {}

  const std::string& what() const { return what_; }
  bool runs() const { return runs_; }
  /// @param runs  the session does, but its haptics does not feel the device yet
  void look(std::int64_t now_ns, bool runs) {
    runs_ = runs;
    if (began_ns_ == 0) began_ns_ = line_ns_ = now_ns;
    if (now_ns - began_ns_ >= longest_ns_) {
      throw std::runtime_error(what_ + (runs ? " has not felt the device" : " has not begun") +
                               " within " + std::to_string(longest_ns_ / kNanosecondsPerSecond) +
                               " s");
    }
    if (now_ns - line_ns_ < kWaitingLineEveryNs) return;
    line_ns_ = now_ns;
    std::cerr << kName << ": waiting for " << what_ << (runs ? " to feel the device" : " to begin")
              << std::endl;
  }

 private:
  std::string what_;
  bool runs_ = false;
  std::int64_t longest_ns_, began_ns_ = 0, line_ns_ = 0;
};

/// Until the session ends, a signal comes or time is up; the hand takes the device once the session
/// runs and haptics feels where it is, or it would be deep in an organ by then, and holds it while
/// the session pauses.
/// @throws Interrupted, std::runtime_error where it ends before the session ran: nothing was felt
void run(const Options& options, const scene::Scene& scene, launcher::EmulatedDriver& driver,
         bus::Bus& bus, launcher::DeviceLog& log) {
  const StopSignal stop;
  runtime::Session session(bus, scene::scene_digest(scene));
  runtime::PeriodicLoop loop(1 / driver.device().period());
  std::int64_t began_ns = 0;
  Waiting waiting(options);
  while (!stop.requested() && session.phase() != runtime::SessionPhase::kStopped) {
    if (!loop.wait_for_period()) continue;
    session.poll();
    if (!session.fault().empty()) throw InputError(session.fault());
    const std::int64_t now_ns = loop.period_began_ns();
    if (began_ns == 0 && session.running() && driver.is_felt(now_ns)) began_ns = now_ns;
    if (began_ns == 0) {
      driver.cycle(now_ns, std::nullopt);
      waiting.look(now_ns, session.running());
      continue;
    }
    const std::int64_t period = (now_ns - began_ns) / loop.period_ns();
    driver.cycle(now_ns, period);
    const double time = static_cast<double>(period) * driver.device().period();
    log.add(now_ns, time, driver.device().position(), driver.device().motor_force());
    if (options.duration > 0 && time >= options.duration) break;
  }
  if (began_ns == 0 && stop.requested()) {
    throw Interrupted("stopped; " + waiting.what() +
                      (waiting.runs() ? " had not felt the device" : " had not begun") +
                      ", the probe was not moved");
  }
  if (began_ns == 0) {
    throw std::runtime_error(waiting.what() + " ended before it " +
                             (waiting.runs() ? "felt the device" : "ran"));
  }
  const runtime::LoopStatistics& statistics = loop.statistics();
  std::cerr << kName << ": " << statistics.cycles << " periods, "
            << 100 * statistics.on_time_fraction() << " % on time\n";
}

void attach(const Options& options) {
  const scene::Scene scene = scene::load_scene(scene::scene_file(options.scene));
  std::optional<WholeFile> table;
  if (!options.table.empty()) {
    table.emplace(options.table, launcher::kDeviceTable, "table of a device");
  }
  const std::uint32_t probe = probe_of(scene, options.probe);
  const scene::EmulatedDevice device = scene::parse_emulated_device(
      options.device, "--device", std::get<scene::TopicDevice>(scene.probes[probe].device));
  if (options.realtime) {
    const runtime::Realtime granted = runtime::request_realtime(kFifo, false);
    if (!granted.refused.empty()) std::cerr << kName << ": " << granted.refused << '\n';
  }
  bus::DdsBus bus(options.bus);
  launcher::EmulatedDriver driver(device, probe, bus);
  launcher::DeviceLog log(std::cout, table ? &table->stream() : nullptr);
  run(options, scene, driver, bus, log);
  if (table) table->finish();
  std::cout << scene.probes[probe].name << ": " << log.summary() << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  runtime::Program program("Moves a probe of a running session as a haptic device in a hand would",
                           kName);
  Options options;
  options.bus.participant_name = "emulated_device";
  program
      .add_input("SCENE", options.scene,
                 "Scene of the session, file or name of a shipped one; the probe's device is topic")
      .required();
  program.add("--probe", options.probe, "Name of the probe; else the first with device topic");
  program.add("--device", options.device,
              "Device and hand: the keys of a scene's `emulated`, such as "
              "'{kind: omega, hand: {push_n: [0, 0, -0.2]}}'");
  runtime::add_bus_options(program, options.bus);
  program
      .add("--duration", options.duration,
           "Seconds of the session, which is waited for as long, or 10 s; else until it ends")
      .range(0.001, 1e6);
  program.add_output(
      "--csv", options.table,
      "Place and force of each period, written at the end; an earlier one is replaced");
  program.flag_off("--no-realtime", options.realtime, "Do not ask for real-time priority");
  program.footer(
      "Exit code: 0 if it moved the probe until the session ended, its time was up or it was "
      "stopped, 1 if the session did not run, 2 for bad input, 130 if it was stopped before.");
  return program.run(argc, argv, [&] {
    outlive_readers();
    attach(options);
    return kExitDone;
  });
}
