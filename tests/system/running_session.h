// The real processes of a scene, with a test in the launcher's place.
#pragma once

#include <algorithm>
#include <csignal>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "modules/bus/dds_bus.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/session.h"
#include "modules/scene/scene_reader.h"
#include "palpate/child_process.h"
#include "tests/modules/runtime/own_bus.h"
#include "tests/palpate/ball_scene.h"

namespace palpate::testing {

/// The newest of all that a session says.
struct Heard {
  NodePositions nodes;
  ContactModel model;
  HapticForce force;
  ProbeState probe;
  Contacts contacts;
  std::map<std::string, ModuleStatus> modules;
  double largest_force_step = 0;    ///< per haptic tick, between samples that were heard [N]
  double largest_force = 0;         ///< since forget_largest() [N]
  std::int64_t last_pushed_ns = 0;  ///< source time of the last force that was not zero
  std::int64_t last_driven_ns = 0;  ///< source time of the last pose that the test wrote

  void hear(const HapticForce& next) {
    const auto ticks = static_cast<double>(next.header.sequence - force.header.sequence);
    if (force.header.sequence > 0 && next.header.sequence > force.header.sequence) {
      const double step = (next.force - force.force).norm() / ticks;
      largest_force_step = std::max(largest_force_step, step);
    }
    largest_force = std::max(largest_force, next.force.norm());
    if (next.force.norm() > 0) last_pushed_ns = next.header.source_time_ns;
    force = next;
  }
};

class RunningSession {
 public:
  explicit RunningSession(const BallScene& scene)
      : scene_file_(scene.file()),
        scene_(scene::load_scene(scene.file())),
        session_(bus_, scene::scene_digest(scene_)),
        conductor_(bus_) {}

  void start_module(const std::string& name) {
    children_[name] = std::make_unique<launcher::ChildProcess>(
        std::filesystem::path(PALPATE_BIN_DIR) / ("palpate-" + name),
        std::vector<std::string>{scene_file_.string(), "--session", options_.session, "--domain",
                                 std::to_string(options_.domain)});
  }

  /// All three, ready, and the session started. False after the deadline.
  bool start() {
    for (const char* name : {"deformation", "collision", "haptics"}) start_module(name);
    const bool ready = wait([&](const Heard& heard) {
      return heard.modules.size() == 3 &&
             heard.modules.at("haptics").state >= ModuleState::kReady &&
             heard.modules.at("collision").state >= ModuleState::kReady &&
             heard.modules.at("deformation").state >= ModuleState::kReady;
    });
    command(SessionCommand::kStart);
    return ready && wait([&](const Heard& heard) {
             return heard.modules.at("deformation").state >= ModuleState::kRunning;
           });
  }

  void command(SessionCommand wanted) {
    session_.poll();
    conductor_.command(session_.state(), wanted);
  }

  /// Moves the finger to a height, as a hand would; said again and again.
  void move_finger(double height) { wanted_height_ = height; }
  /// The finger's driver says no more, until it is moved again: from that height.
  void silence_driver(double height) {
    wanted_height_ = 0;
    height_ = height;
  }

  /// Listens until the condition holds; false after the deadline.
  template <class Condition>
  bool wait(const Condition& condition, double deadline = kDeadline) {
    return wait_until(
        [&] {
          listen();
          return condition(heard_);
        },
        deadline);
  }

  /// Presses and waits until the finger feels at least this much [N].
  bool press(double force) {
    move_finger(kFingerPressing);
    return wait([&](const Heard& heard) { return heard.force.force.norm() > force; });
  }

  /// The same, and until the organ rests. @returns the force then [N]; 0: it was not felt
  double rest_pressed(double force) {
    if (!press(force)) return 0;
    listen_for(1);
    return heard_.force.force.norm();
  }

  void listen_for(double seconds) {
    wait([](const Heard&) { return false; }, seconds);
  }

  /// Whether all modules have refused more packets than that, and go on.
  bool all_go_on_refusing(std::uint64_t packets) {
    return std::ranges::all_of(children_, [&](const auto& child) {
      const std::string& name = child.first;
      const bool refused = wait(
          [&](const Heard& heard) { return heard.modules.at(name).packets_refused > packets; });
      return refused && !child.second->ended().has_value() &&
             heard_.modules.at(name).state == ModuleState::kRunning;
    });
  }

  void kill(const std::string& name) {
    children_.at(name)->signal(SIGKILL);
    wait_until([&] { return children_.at(name)->ended().has_value(); });
  }

  void forget_largest() { heard_.largest_force = heard_.largest_force_step = 0; }

  launcher::ChildProcess& child(const std::string& name) { return *children_.at(name); }
  const Heard& heard() const { return heard_; }
  const bus::BusOptions& options() const { return options_; }
  const scene::Scene& scene() const { return scene_; }

 private:
  void listen() {
    session_.poll();
    if (wanted_height_ != 0) drive();
    while (nodes_.take(heard_.nodes)) {
    }
    while (models_.take(heard_.model)) {
    }
    HapticForce force;
    while (forces_.take(force)) heard_.hear(force);
    while (probes_.take(heard_.probe)) {
    }
    while (contacts_.take(heard_.contacts)) {
    }
    ModuleStatus status;
    while (statuses_.take(status)) heard_.modules[status.module] = status;
  }

  void drive() {
    const std::int64_t now_ns = runtime::monotonic_now_ns();
    const double most = kFingerSpeed * 1e-9 * double(std::min(now_ns - driven_ns_, kLongestMoveNs));
    height_ += std::clamp(wanted_height_ - height_, -most, most);
    driven_ns_ = now_ns;
    ProbeState input;
    input.header.source_time_ns = heard_.last_driven_ns = now_ns;
    input.pose.position = Vec3(0, 0, height_);
    inputs_.write(input);
  }

  static constexpr double kFingerSpeed = 0.3;                ///< [m/s]
  static constexpr std::int64_t kLongestMoveNs = 5'000'000;  ///< however late the test wakes
  std::filesystem::path scene_file_;
  scene::Scene scene_;
  bus::BusOptions options_ = own_bus_options();
  bus::DdsBus bus_{options_};
  runtime::Session session_;
  runtime::SessionConductor conductor_;
  bus::Writer<ProbeState> inputs_ = bus_.writer(bus::kProbeInput);
  bus::Reader<NodePositions> nodes_ = bus_.reader(bus::kNodePositions);
  bus::Reader<ContactModel> models_ = bus_.reader(bus::kContactModel);
  bus::Reader<HapticForce> forces_ = bus_.reader(bus::kHapticForce);
  bus::Reader<ProbeState> probes_ = bus_.reader(bus::kProbeState);
  bus::Reader<Contacts> contacts_ = bus_.reader(bus::kContacts);
  bus::Reader<ModuleStatus> statuses_ = bus_.reader(bus::kModuleStatus);
  Heard heard_;
  double wanted_height_ = 0, height_ = kFingerStart;  ///< wanted 0: nobody drives
  std::int64_t driven_ns_ = 0;
  std::map<std::string, std::unique_ptr<launcher::ChildProcess>> children_;
};

}  // namespace palpate::testing
