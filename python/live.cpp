#include "python/live.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "modules/bus/dds_bus.h"
#include "modules/messages/describe.h"
#include "modules/messages/key_of.h"
#include "python/busy.h"
#include "python/message_arrays.h"
#include "python/topic_columns.h"
#include "python/unlocked.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

constexpr std::chrono::milliseconds kLookAgain{2};
constexpr double kLongestWait = 1e6;                   ///< [s]
constexpr std::size_t kMostUntakenBytes = 256u << 20;  ///< of a topic
constexpr const char* kWhat = "the connection";

std::string key_text_of(const messages::AnyMessage& message) {
  messages::KeyOf key;
  std::visit([&](const auto& m) { messages::describe(key, m); }, message);
  return key.text;
}

bus::GuidPrefix participant_of(const bus::WriterId& writer) {
  bus::GuidPrefix participant;
  std::copy_n(writer.begin(), participant.size(), participant.begin());
  return participant;
}

bus::BusOptions options_of(const std::string& session, int domain) {
  bus::BusOptions options;
  options.session = session;
  options.domain = domain;
  options.participant_name = "palpate python";
  return options;
}

}  // namespace

Live::Live(const std::string& session, int domain)
    : bus_(std::make_unique<bus::DdsBus>(options_of(session, domain))) {
  input_.emplace(bus_->writer(bus::kProbeInput));
  controls_.emplace(bus_->reader(bus::kSessionControl, bus::Keep::kBacklog));
  scenes_.emplace(bus_->reader(bus::kScene, bus::Keep::kBacklog));
  conductor_.emplace(*bus_);
}

void Live::check_open() const {
  if (closed_) throw ClosedError("the connection is closed");
}

Live::Topic& Live::topic_of(const std::string& name) {
  const auto found = topics_.find(name);
  if (found != topics_.end()) return found->second;
  const bus::TopicInfo* info = bus::find_topic(name);
  if (info == nullptr) throw py::key_error("no topic '" + name + "'");
  auto reader = bus_->raw_reader(*info, bus::Keep::kBacklog);
  return topics_.emplace(name, Topic{info, std::move(reader), false, {}, 0, {}, {}}).first->second;
}

void Live::receive(Topic& topic) {
  bus::RawSample sample;
  while (topic.reader->take(sample)) {
    auto message = std::make_shared<messages::AnyMessage>();
    if (topic.info->type->decode(sample.payload, *message) != nullptr) continue;
    topic.last_key = key_text_of(*message);
    topic.newest[topic.last_key] = message;
    if (topic.is_taken)
      keep(topic, {std::move(message), sizeof(messages::AnyMessage) + sample.payload.size()});
  }
}

void Live::keep(Topic& topic, Untaken untaken) {
  topic.untaken_bytes += untaken.bytes;
  topic.untaken.push_back(std::move(untaken));
  while (topic.untaken_bytes > kMostUntakenBytes) {
    topic.untaken_bytes -= topic.untaken.front().bytes;
    topic.untaken.pop_front();
  }
}

void Live::poll_controls() {
  SceneDescription scene;
  while (scenes_->take(scene)) launchers_.insert(participant_of(scenes_->writer()));
  SessionControl control;
  while (controls_->take(control)) {
    state_.apply(control);
    said_by_[participant_of(controls_->writer())] = control.header.source_time_ns;
  }
}

std::int64_t Live::launcher_said_ns() const {
  std::int64_t newest_ns = 0;
  for (const auto& [participant, time_ns] : said_by_) {
    if (launchers_.contains(participant)) newest_ns = std::max(newest_ns, time_ns);
  }
  return newest_ns;
}

/// Without the GIL, looking for Ctrl-C meanwhile.
template <class Done>
bool Live::wait_until(double timeout, const Done& done) {
  if (!(timeout >= 0 && timeout <= kLongestWait))
    throw py::value_error("timeout must be between 0 and 1e6 s");
  const Unlocked unlocked;
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  auto look_at = began + kLookForSignals;
  while (!done()) {
    const auto now = Clock::now();
    if (std::chrono::duration<double>(now - began).count() >= timeout) return false;
    if (now >= look_at) {
      Unlocked::look_for_signals();
      look_at = now + kLookForSignals;
    }
    std::this_thread::sleep_for(kLookAgain);
  }
  return true;
}

py::object Live::newest(const std::string& name, const std::string& key, double timeout) {
  const InUse use(in_use_, kWhat);
  check_open();
  Topic& topic = topic_of(name);
  std::shared_ptr<const messages::AnyMessage> found;
  wait_until(timeout, [&] {
    receive(topic);
    const auto it = topic.newest.find(key.empty() ? topic.last_key : key);
    if (it != topic.newest.end()) found = it->second;
    return found != nullptr;
  });
  if (!found) return py::none();
  return arrays_of_any(std::move(found));
}

py::tuple Live::take(const std::string& name) {
  const InUse use(in_use_, kWhat);
  check_open();
  Topic& topic = topic_of(name);
  TopicColumns columns;
  {
    const Unlocked unlocked;
    topic.is_taken = true;
    receive(topic);
    for (const Untaken& untaken : topic.untaken) columns.add(*untaken.message);
    topic.untaken.clear();
    topic.untaken_bytes = 0;
  }
  const std::size_t messages = columns.size();
  return py::make_tuple(columns.take(), messages);
}

bool Live::write_probe_input(const ProbeState& state) {
  const InUse use(in_use_, kWhat);
  check_open();
  ProbeState said = state;
  return input_->write(said);
}

bool Live::control(SessionCommand command, double timeout) {
  const InUse use(in_use_, kWhat);
  check_open();
  // Whoever has just come may first hear what somebody else said before: the launcher's is newest.
  const auto launcher_says_after = [&](std::int64_t time_ns) {
    return wait_until(timeout, [&] {
      poll_controls();
      return launcher_said_ns() > time_ns;
    });
  };
  launcher_says_after(0);
  const std::int64_t before_ns = state_.last_command().header.source_time_ns;
  if (before_ns == 0) return false;
  conductor_->command(state_, command);
  // What a writer said that leaves at once, some may never hear: the launcher says it again, and
  // where processors are busy hears it late.
  launcher_says_after(before_ns);
  return true;
}

std::string Live::phase() {
  const InUse use(in_use_, kWhat);
  check_open();
  poll_controls();
  switch (state_.phase()) {
    case runtime::SessionPhase::kWaiting:
      return "waiting";
    case runtime::SessionPhase::kRunning:
      return "running";
    case runtime::SessionPhase::kPaused:
      return "paused";
    default:
      return "stopped";
  }
}

bool Live::wait_for_haptics(double timeout) {
  const InUse use(in_use_, kWhat);
  check_open();
  return wait_until(timeout, [&] { return input_->matched_readers() > 0; });
}

void Live::close() {
  const InUse use(in_use_, kWhat);
  if (closed_.exchange(true)) return;
  // cppcheck-suppress unreadVariable
  const Unlocked unlocked(Unlocked::AtEnd::kAllowed);
  topics_.clear();
  conductor_.reset();
  controls_.reset();
  scenes_.reset();
  input_.reset();
  bus_.reset();
}

}  // namespace palpate::python
