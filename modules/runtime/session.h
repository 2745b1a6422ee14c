// A module's part in the session: follows session_control and checks that all play the same scene.
#pragma once

#include <string>

#include "modules/bus/bus.h"
#include "modules/runtime/session_state.h"
#include "modules/scene/scene.h"

namespace palpate::runtime {

class Session {
 public:
  enum class Kind { kRealTime, kLockstep };
  /// @param scene_digest  of the scene this module loaded
  /// @param kind  in lockstep commands grant simulated time, and each host has a clock of its own
  Session(bus::Bus& bus, std::string scene_digest, Kind kind = Kind::kRealTime);

  /// Takes what has arrived. No allocation once the scene has come.
  void poll();
  /// Waits until a command may have arrived, at most `longest` [s].
  void wait(double longest) { controls_.wait(longest); }

  SessionPhase phase() const { return state_.phase(); }
  bool running() const { return phase() == SessionPhase::kRunning && fault_.empty(); }
  bool take_reset() { return state_.take_reset(); }
  double time(std::int64_t now_ns) const { return state_.time(now_ns); }  ///< [s]
  const SessionState& state() const { return state_; }

  /// Why this module cannot take part: another scene, another protocol version. Empty if it can.
  const std::string& fault() const { return fault_; }
  /// The session's scene was heard: only then does an empty fault() mean that there is none.
  bool knows_scene() const { return knows_scene_; }

 private:
  /// All of them: of several writers an older one that is said again comes after a newer one.
  bus::Reader<SessionControl> controls_;
  bus::Reader<SceneDescription> scenes_;
  std::string scene_digest_;
  Kind kind_;
  SessionState state_;
  SessionControl control_;
  SceneDescription scene_;
  std::string fault_;
  bool knows_scene_ = false;
};

/// What the launcher tells of the scene: name, digest, resolved text.
SceneDescription scene_description(const scene::Scene& scene);

/// One line saying why a module with `own_digest` cannot play `scene`; empty if it can.
std::string scene_mismatch(const SceneDescription& scene, const std::string& own_digest);

/// Gives the commands. The launcher holds one, and a visualizer whose keys pause and reset.
class SessionConductor {
 public:
  explicit SessionConductor(bus::Bus& bus);

  /// Gives the command that leads on from `state`, as of now. A reset is to be followed by kStart.
  void command(const SessionState& state, SessionCommand wanted);
  /// In real time: `duration` [s] of simulated time from now, then a halt.
  void step(const SessionState& state, double duration);
  /// Lockstep: cycles that begin before `until_ns` may run.
  void grant(const SessionState& state, std::int64_t until_ns);
  /// Says the session's last command again, for whoever missed it.
  void repeat(const SessionState& state);

 private:
  bus::Writer<SessionControl> writer_;
};

}  // namespace palpate::runtime
