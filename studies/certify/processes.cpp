#include "studies/certify/processes.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>

#include "modules/bus/dds_bus.h"
#include "modules/core/data_folder.h"
#include "modules/core/units.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/realtime.h"
#include "modules/runtime/session.h"
#include "modules/scene/scene_reader.h"
#include "studies/certify/hands.h"

namespace palpate::certify {
namespace {

constexpr const char* kModules[] = {"deformation", "collision", "haptics"};
constexpr std::int64_t kPeriodNs = 1'000'000;  // of the driver
constexpr double kReady = 60;                  // [s]
constexpr std::size_t kWritten = 4096;         // poses on their way
constexpr int kPriority = 60;                  // between haptics and the others

scene::Scene with_topic_device(const Subject& subject) {
  scene::Scene scene = subject.scene;
  const Pose above = pose_below(subject.place, -kAbove);
  scene.probes[0].device = scene::TopicDevice{above.position, above.rotation};
  return scene;
}

}  // namespace

struct Processes::Bus {
  Bus(const bus::BusOptions& options, const scene::Scene& scene)
      : realtime(runtime::request_realtime(kPriority, false)),
        bus(options),
        session(bus, scene::scene_digest(scene)),
        conductor(bus),
        scenes(bus.writer(bus::kScene)),
        states(bus.reader(bus::kProbeState)),
        forces(bus.reader(bus::kHapticForce)),
        laws(bus.reader(bus::kContactModel)),
        contacts(bus.reader(bus::kContacts)),
        statuses(bus.reader(bus::kModuleStatus)) {}
  ~Bus() { runtime::give_up_realtime(); }

  runtime::Realtime realtime;  // before the bus, whose threads inherit
  bus::DdsBus bus;
  runtime::Session session;
  runtime::SessionConductor conductor;
  bus::Writer<SceneDescription> scenes;
  bus::Reader<ProbeState> states;
  bus::Reader<HapticForce> forces;
  bus::Reader<ContactModel> laws;
  bus::Reader<Contacts> contacts;
  bus::Reader<ModuleStatus> statuses;
  ProbeState state;
  HapticForce force;
  ContactModel law;
  Contacts touched;
  ModuleStatus status;
};

Processes::Processes(const Subject& subject, const bus::BusOptions& bus,
                     const std::filesystem::path& folder, KeepGoing keep_going, Beside beside)
    : subject_(subject),
      options_(bus),
      keep_going_(std::move(keep_going)),
      scene_(with_topic_device(subject)),
      file_(std::filesystem::absolute(folder) / "certified.yaml"),
      written_ns_(kWritten),
      tally_(scene_) {
  std::ofstream(file_) << scene::resolved_text(scene_);
  scene_ = scene::load_scene(file_);  // its digest is what the others compare
  for (const char* module : kModules) start_module(module);
  if (beside == Beside::kPicturesAndHog) {
    start_module("visualizer", {"--headless"});
    children_["hog"] = std::make_unique<launcher::ChildProcess>(
        "/bin/sh", std::vector<std::string>{"-c", "while :; do :; done"});
  }
  bus_ = std::make_unique<Bus>(options_, scene_);
  tell_scene("");
  hold(firm_hand(subject.device, subject.place, {}));
  began_ns_ = 0;
}

Processes::~Processes() {
  bus_->conductor.command(bus_->session.state(), SessionCommand::kStop);
  for (auto& [module, child] : children_) child->signal(SIGTERM);
  const std::int64_t deadline_ns = runtime::monotonic_now_ns() + 2 * kNanosecondsPerSecond;
  for (auto& [module, child] : children_) {
    while (!child->ended() && runtime::monotonic_now_ns() < deadline_ns) {
      bus_->forces.wait(0.01);
      child->take_lines();
    }
  }
}

void Processes::start_module(const std::string& module, std::vector<std::string> more) {
  std::vector<std::string> arguments{file_.string(), "--session", options_.session, "--domain",
                                     std::to_string(options_.domain)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  children_[module] =
      std::make_unique<launcher::ChildProcess>(program_folder() / ("palpate-" + module), arguments);
}

bool Processes::start() {
  if (!wait(
          [](const Heard& heard) {
            return std::all_of(std::begin(kModules), std::end(kModules), [&](const char* module) {
              const auto found = heard.modules.find(module);
              return found != heard.modules.end() && found->second.state >= ModuleState::kReady;
            });
          },
          kReady)) {
    return false;
  }
  command(SessionCommand::kStart);
  return true;
}

void Processes::hold(const scene::EmulatedDevice& hand) {
  driver_ = std::make_unique<launcher::EmulatedDriver>(hand, 0, bus_->bus);
  began_ns_ = runtime::monotonic_now_ns();
  heard_.held.clear();
}

bool Processes::wait(const std::function<bool(const Heard&)>& condition, double longest) {
  const std::int64_t deadline_ns = runtime::monotonic_now_ns() + ns_from_seconds(longest);
  while (runtime::monotonic_now_ns() < deadline_ns) {
    keep_going_();
    tick();
    if (condition(heard_)) return true;
  }
  return false;
}

/// One period of the driver: a pose, then whatever comes until the next.
void Processes::tick() {
  std::int64_t now_ns = runtime::monotonic_now_ns();
  if (next_ns_ < now_ns - kPeriodNs) next_ns_ = now_ns;  // late: what has passed is not made up for
  next_ns_ += kPeriodNs;
  if (driving_) drive_device(now_ns);
  for (; now_ns < next_ns_; now_ns = runtime::monotonic_now_ns()) {
    bus_->forces.wait(seconds_from_ns(next_ns_ - now_ns));
    listen(runtime::monotonic_now_ns());
  }
  bus_->session.poll();
  while (bus_->laws.take(bus_->law)) heard_.hear_law(bus_->law.header.source_time_ns);
  while (bus_->contacts.take(bus_->touched)) {
    heard_.last_contacts_ns = bus_->touched.header.source_time_ns;
  }
  while (bus_->statuses.take(bus_->status)) {
    heard_.modules[bus_->status.module] = bus_->status;
    tally_.receive(bus_->status);
  }
  for (auto& [module, child] : children_) child->take_lines();
}

void Processes::drive_device(std::int64_t now_ns) {
  const haptics::EmulatedDevice& device = driver_->device();
  std::optional<std::int64_t> period;
  if (began_ns_ > 0) period = std::llround(seconds_from_ns(now_ns - began_ns_) / device.period());
  ++count_;  // comes back as the buttons in the probe_state of the tick that used the pose
  written_ns_[count_ % kWritten] = heard_.last_driven_ns = now_ns;
  driver_->cycle(now_ns, period, count_);
  if (!period) return;
  Tick& tick = heard_.held.emplace_back();
  tick.time = static_cast<double>(*period) * device.period();
  tick.off = device.position() - subject_.place.pose.position;
  tick.depth = tick.off.dot(subject_.place.into);
  tick.motor = -device.motor_force().dot(subject_.place.into);
  if (!device.motor_force().isZero(0)) heard_.last_motor_ns = now_ns;
}

void Processes::listen(std::int64_t now_ns) {
  while (bus_->forces.take(bus_->force)) hear(bus_->force, now_ns);
}

void Processes::hear(const HapticForce& force, std::int64_t now_ns) {
  const Header &before = heard_.force.header, &now = force.header;
  const bool follows = before.sequence > 0 && now.sequence == before.sequence + 1;
  if (follows) {
    heard_.largest_step = std::max(heard_.largest_step, (force.force - heard_.force.force).norm());
  }
  if (heard_.timing && follows) {
    heard_.periods.push_back(seconds_from_ns(now.source_time_ns - before.source_time_ns));
  }
  if (!force.force.isZero(0)) heard_.last_pushed_ns = now.source_time_ns;
  // Who is killed between two sends has said its last to haptics, and not here.
  if (std::isfinite(force.contact_model_age)) {
    heard_.hear_law(now.source_time_ns - ns_from_seconds(force.contact_model_age));
  }
  while (bus_->states.take(bus_->state)) {
    const std::uint32_t answered = bus_->state.buttons;
    if (bus_->state.header.source_time_ns != now.source_time_ns || answered == answered_) continue;
    answered_ = answered;
    if (heard_.timing && count_ - answered < kWritten) {
      heard_.latencies.push_back(seconds_from_ns(now_ns - written_ns_[answered % kWritten]));
    }
  }
  heard_.force = force;
}

void Processes::kill(const std::string& module) {
  children_.at(module)->signal(SIGKILL);
  heard_.modules.erase(module);
}

void Processes::start_again(const std::string& module) { start_module(module); }

void Processes::drive(bool on) { driving_ = on; }

void Processes::command(SessionCommand wanted) {
  bus_->session.poll();
  bus_->conductor.command(bus_->session.state(), wanted);
}

void Processes::tell_scene(const std::string& another) {
  SceneDescription description = runtime::scene_description(scene_);
  if (!another.empty()) description.digest = description.name = another;
  bus_->scenes.write(description);
}

}  // namespace palpate::certify
