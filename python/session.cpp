#include "python/session.h"

#include <chrono>
#include <cmath>

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/recording/recorder_stage.h"
#include "modules/runtime/session.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/processes.h"
#include "modules/scene/scene_error.h"
#include "python/busy.h"
#include "python/message_arrays.h"
#include "python/topic_columns.h"
#include "python/unlocked.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

/// In a snapshot beside the modules' states: which probes Python guides. None: no probe.
const std::string kGuided = "python";
constexpr double kLongest = 1e6;  ///< of a session [s], as a scene's duration_s

/// How far a node has gone since it was looked at last [m].
class Motion {
 public:
  explicit Motion(const deformation::DeformationWorld& world) : world_(world) { look(); }
  double look() {
    double furthest = 0;
    before_.resize(world_.organ_count());
    for (std::size_t organ = 0; organ < world_.organ_count(); ++organ) {
      const auto now = world_.positions(organ);
      auto& before = before_[organ];
      before.resize(now.size(), Vec3::Zero());
      for (std::size_t i = 0; i < now.size(); ++i) {
        furthest = std::max(furthest, (now[i] - before[i]).squaredNorm());
        before[i] = now[i];
      }
    }
    return std::sqrt(furthest);
  }

 private:
  const deformation::DeformationWorld& world_;
  std::vector<std::vector<Vec3>> before_;
};

/// Hears a topic while a session runs.
struct Heard {
  const bus::TopicInfo* topic;
  std::unique_ptr<bus::RawReader> reader;
  bus::RawSample sample;
  messages::AnyMessage message;
  TopicColumns columns;

  void listen() {
    while (reader->take(sample)) {
      if (topic->type->decode(sample.payload, message) == nullptr) columns.add(message);
    }
  }
};

template <class Message>
py::dict newest_of(const session::InProcess& session, std::size_t key) {
  return arrays_of(session.shared<Message>(key));
}

const bus::TopicInfo& topic_named(const std::string& name) {
  const bus::TopicInfo* topic = bus::find_topic(name);
  if (topic != nullptr) return *topic;
  std::string all;
  for (const auto& known : bus::all_topics())
    all += (all.empty() ? "" : ", ") + std::string(known.name);
  throw py::key_error("no topic '" + name + "'; there are: " + all);
}

}  // namespace

Session::Session(const scene::Scene& scene, const std::string& record,
                 const std::string& from_snapshot)
    : scene_(scene),
      period_(1 / scene.rates.deformation),
      team_(std::make_unique<runtime::WorkerTeam>(scene.deformation_threads)),
      guided_(scene.probes.size(), nullptr) {
  const Unlocked unlocked;
  session::InProcessOptions options;
  options.runner = team_.get();
  runtime::Snapshot from;
  if (!from_snapshot.empty()) {
    from = runtime::read_snapshot(from_snapshot, scene_);
    options.from = &from;
    options.from_file = from_snapshot;
    options.make = [&](std::string_view module, bus::Bus& bus, const session::MakeStage& usual) {
      auto stage = usual(bus);
      if (module == "haptics") guide_as_in(from, dynamic_cast<haptics::HapticsStage&>(*stage));
      return stage;
    };
  }
  session_ = std::make_unique<session::InProcess>(scene_, session::load_assets(scene_), options);
  time_ = asked_for_ = session_->time();
  // As `palpate run --in-process` does it, so that recordings are the same.
  SceneDescription description = runtime::scene_description(scene_);
  description.header.source_time_ns = runtime::CycleGrid::kSetUp;
  scenes_.emplace(session_->bus().writer(bus::kScene)).write(description);
  if (record.empty()) return;
  session_->add("recorder", [&](bus::Bus& bus) {
    return std::make_unique<recording::RecorderStage>(bus, record);
  });
}

/// Their devices remember, too.
void Session::guide_as_in(const runtime::Snapshot& snapshot, haptics::HapticsStage& haptics) {
  const auto told = snapshot.modules.find(kGuided);
  if (told == snapshot.modules.end()) return;
  std::vector<std::uint32_t> probes;
  StateArchive archive(told->second);
  archive(probes);
  for (const std::uint32_t probe : probes) {
    auto device = std::make_unique<GuidedDevice>();
    guided_.at(probe) = device.get();
    haptics.set_device(probe, std::move(device));
  }
}

double Session::save_snapshot(const std::string& file, bool overwrite) {
  const InUse use(in_use_, "the session");
  open();
  // cppcheck-suppress unreadVariable
  const Unlocked unlocked;
  runtime::check_snapshot_name(file, overwrite, "overwrite=True");
  runtime::Snapshot now = session_->snapshot();
  std::vector<std::uint32_t> probes;
  for (std::uint32_t probe = 0; probe < guided_.size(); ++probe) {
    if (guided_[probe] != nullptr) probes.push_back(probe);
  }
  if (!probes.empty()) {
    StateArchive archive;
    archive(probes);
    now.modules[kGuided] = archive.bytes();
  }
  runtime::write_snapshot(file, scene_, now);
  return seconds_from_ns(now.time_ns);
}

session::InProcess& Session::open() const {
  if (!session_) throw ClosedError("the session is closed");
  return *session_;
}

void Session::check_probe(std::size_t probe) const {
  if (probe < scene_.probes.size()) return;
  throw py::index_error("no probe " + std::to_string(probe) + ": the scene has " +
                        std::to_string(scene_.probes.size()));
}

void Session::check_organ(std::size_t organ) const {
  if (organ < scene_.organs.size()) return;
  throw py::index_error("no organ " + std::to_string(organ) + ": the scene has " +
                        std::to_string(scene_.organs.size()));
}

void Session::check_time(double time) const {
  if (!(time >= 0 && time <= kLongest))
    throw py::value_error("a time must be between 0 and 1e6 s, not " + std::to_string(time));
}

/// Ctrl-C leaves the session between two instants: it can go on.
void Session::run_while(const std::function<bool()>& wanted, const Listener& listen) {
  const Unlocked unlocked;
  auto look_at = std::chrono::steady_clock::now() + kLookForSignals;
  while (wanted()) {
    session_->tick();
    time_ = session_->time();
    if (listen) listen();
    const auto now = std::chrono::steady_clock::now();
    if (now < look_at) continue;
    Unlocked::look_for_signals();
    look_at = now + kLookForSignals;
  }
}

void Session::run_until(double time) {
  const InUse use(in_use_, "the session");
  open();
  check_time(time);
  asked_for_ = std::max(asked_for_, time);
  const std::int64_t until_ns = ns_from_seconds(time);
  run_while([&] { return ns_from_seconds(session_->time()) < until_ns; }, {});
}

void Session::step(std::size_t periods) {
  const InUse use(in_use_, "the session");
  const std::int64_t period_ns = runtime::CycleGrid(scene_.rates.deformation).period_ns();
  const std::int64_t now_ns = ns_from_seconds(open().time());
  const double most = kLongest / seconds_from_ns(period_ns);
  if (static_cast<double>(periods) > most)
    throw py::value_error("that many periods take over 1e6 s");
  // From where it is to as many whole periods further on the grid of deformation.
  const std::int64_t until_ns =
      (now_ns / period_ns + static_cast<std::int64_t>(periods)) * period_ns;
  asked_for_ = std::max(asked_for_, seconds_from_ns(until_ns));
  run_while([&] { return ns_from_seconds(session_->time()) < until_ns; }, {});
}

bool Session::settle(double speed, double still, double time) {
  const InUse use(in_use_, "the session");
  open();
  check_time(time);
  if (!(speed > 0) || !(still >= 0)) throw py::value_error("speed must be > 0 and still ≥ 0");
  Motion motion(session_->world());
  double moved_at = session_->time(), looked_at = moved_at;
  bool settled = false;
  run_while([&] { return !settled && session_->time() < time; },
            [&] {
              const double now = session_->time();
              if (now - looked_at < 0.999 * period_) return;
              if (motion.look() > speed * (now - looked_at)) moved_at = now;
              looked_at = now;
              settled = now - moved_at >= still;
            });
  asked_for_ = std::max(asked_for_, session_->time());
  return settled;
}

py::list Session::run_keeping(double time, const std::vector<std::string>& topics) {
  const InUse use(in_use_, "the session");
  open();
  check_time(time);
  std::vector<Heard> heard;
  for (const std::string& name : topics) {
    const bus::TopicInfo& topic = topic_named(name);
    heard.push_back({&topic, session_->bus().raw_reader(topic, bus::Keep::kBacklog), {}, {}, {}});
  }
  asked_for_ = std::max(asked_for_, time);
  const std::int64_t until_ns = ns_from_seconds(time);
  run_while([&] { return ns_from_seconds(session_->time()) < until_ns; },
            [&] {
              for (Heard& topic : heard) topic.listen();
            });
  py::list result;
  for (Heard& topic : heard) {
    topic.listen();
    const std::size_t messages = topic.columns.size();
    result.append(py::make_tuple(std::string(topic.topic->name), topic.columns.take(), messages));
  }
  return result;
}

void Session::close() {
  const InUse use(in_use_, "the session");
  if (!session_) return;
  // cppcheck-suppress unreadVariable
  const Unlocked unlocked(Unlocked::AtEnd::kAllowed);
  closed_ = true;
  guided_.clear();
  // Taken out first: what finish() throws leaves nothing open. Gone in this order, the last first.
  const auto team = std::move(team_);
  const auto session = std::move(session_);
  const auto scenes = std::move(scenes_);
  scenes_.reset();
  session->finish(std::min(asked_for_, session->time()));
}

void Session::guide_probe(std::size_t probe, const Pose& pose, const Twist& twist) {
  const InUse use(in_use_, "the session");
  open();
  check_probe(probe);
  if (guided_[probe] == nullptr) {
    auto device = std::make_unique<GuidedDevice>();
    guided_[probe] = device.get();
    session_->haptics().set_device(probe, std::move(device));
  }
  guided_[probe]->guide(pose, twist);
}

void Session::ask_for_volume(std::size_t organ, double ratio) {
  const InUse use(in_use_, "the session");
  open();
  check_organ(organ);
  if (!(ratio >= 0.2 && ratio <= 5))  // as a scene's volume_ratio
    throw py::value_error("a volume ratio must be between 0.2 and 5, not " + std::to_string(ratio));
  session_->ask_for_volume(organ, ratio);
}

py::dict Session::newest(const std::string& topic, std::size_t key) {
  const InUse use(in_use_, "the session");
  const session::InProcess& session = open();
  const bool of_organ = topic == "node_positions" || topic == "surface";
  topic_named(topic);
  of_organ ? check_organ(key) : check_probe(key);
  if (topic == "node_positions") return newest_of<NodePositions>(session, key);
  if (topic == "surface") return newest_of<SurfaceTopology>(session, key);
  if (topic == "probe_state") return newest_of<ProbeState>(session, key);
  if (topic == "contacts") return newest_of<Contacts>(session, key);
  if (topic == "contact_model") return newest_of<ContactModel>(session, key);
  if (topic == "haptic_force") return newest_of<HapticForce>(session, key);
  throw py::key_error("topic '" + topic + "' is not kept by a session in process");
}

std::vector<std::string> Session::guards() {
  const InUse use(in_use_, "the session");
  std::vector<std::string> acting;
  std::vector<std::string> modules{"haptics", "collision"};
  for (std::size_t process = 1; process <= scene::process_count(open().scene()); ++process) {
    modules.push_back(runtime::name_of({"deformation", process}));
  }
  for (const std::string& module : modules) {
    const std::string guard = open().health(module).guard;
    if (!guard.empty()) acting.push_back(module + ": " + guard);
  }
  return acting;
}

}  // namespace palpate::python
