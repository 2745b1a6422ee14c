#include "modules/runtime/session.h"

#include "modules/runtime/clock.h"
#include "modules/scene/scene_reader.h"

namespace palpate::runtime {

Session::Session(bus::Bus& bus, std::string scene_digest, Kind kind)
    : controls_(bus.reader(bus::kSessionControl, bus::Keep::kBacklog)),
      scenes_(bus.reader(bus::kScene)),
      scene_digest_(std::move(scene_digest)),
      kind_(kind) {}

void Session::poll() {
  while (controls_.take(control_)) {
    if (kind_ == Kind::kRealTime && !state_.believes(control_, monotonic_now_ns())) continue;
    state_.apply(control_);
  }
  while (scenes_.take(scene_)) {
    fault_ = scene_mismatch(scene_, scene_digest_);
    knows_scene_ = true;
  }
}

SceneDescription scene_description(const scene::Scene& scene) {
  SceneDescription description;
  description.name = scene.name;
  description.digest = scene::scene_digest(scene);
  description.resolved_text = scene::resolved_text(scene);
  return description;
}

std::string scene_mismatch(const SceneDescription& scene, const std::string& own_digest) {
  if (scene.protocol_version != kProtocolVersion) {
    return "the session speaks protocol version " + std::to_string(scene.protocol_version) +
           ", this module " + std::to_string(kProtocolVersion) + ": use programs of one release";
  }
  if (scene.digest != own_digest) {
    return "the session plays scene '" + scene.name + "' (digest " + scene.digest +
           "), this module loaded another (digest " + own_digest +
           "): start it with the same scene file and meshes";
  }
  return {};
}

SessionConductor::SessionConductor(bus::Bus& bus) : writer_(bus.writer(bus::kSessionControl)) {}

void SessionConductor::command(const SessionState& state, SessionCommand wanted) {
  SessionControl message = next_command(state, wanted, monotonic_now_ns());
  writer_.write(message);
}

void SessionConductor::step(const SessionState& state, double duration) {
  SessionControl message = step_command(state, duration, monotonic_now_ns());
  writer_.write(message);
}

void SessionConductor::grant(const SessionState& state, std::int64_t until_ns) {
  SessionControl message = next_command(state, SessionCommand::kStep, monotonic_now_ns());
  message.header.sim_time_ns = state.granted_until_ns();
  message.until_ns = until_ns;
  writer_.write(message);
}

void SessionConductor::repeat(const SessionState& state) {
  SessionControl message = state.last_command();
  if (message.header.source_time_ns != 0) writer_.write(message);
}

}  // namespace palpate::runtime
