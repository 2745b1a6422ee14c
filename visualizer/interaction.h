// Keys and mouse → view options, camera, pressing and dragged probes, session commands. No window
// needed.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "visualizer/camera.h"
#include "visualizer/probe_drag.h"
#include "visualizer/scene_view.h"
#include "visualizer/surface_press.h"
#include "visualizer/view_options.h"

namespace palpate::visualizer {

enum class MouseButton { kNone, kLeft, kMiddle, kRight };

/// One event of the window, in pixels with y up.
struct InputEvent {
  enum class Kind { kPress, kRelease, kMove, kWheel, kKey, kClose };
  Kind kind = Kind::kMove;
  double x = 0, y = 0;
  MouseButton button = MouseButton::kNone;  ///< of kPress and kRelease
  bool shift = false, control = false;
  double wheel_steps = 0;  ///< of kWheel, forward positive
  std::string key;         ///< of kKey: "h", "1", "space", …
};

/// What the keys do, for the help: key and meaning, in the help's order.
struct KeyMeaning {
  const char* key;
  const char* meaning;
};
std::span<const KeyMeaning> key_meanings();

/// The scene's camera, else all organs from the front.
Camera home_camera(const SceneView& view, int width, int height);

/// Requests of the person that others have to carry out.
struct Requests {
  bool close = false;    ///< this window
  bool end_run = false;  ///< and the run
  bool screenshot = false, pause_or_resume = false, reset = false;
  bool step = false, slow_motion = false, record = false;  ///< the latter two: on or off
  std::vector<ProbeState> probe_inputs;  ///< of probes taken over; headers are the sender's
};

class Interaction {
 public:
  /// @param bodies  of the scene's probes
  explicit Interaction(std::vector<ProbeBody> bodies) : bodies_(std::move(bodies)) {}

  /// Carries out what concerns the picture; returns the rest.
  Requests handle(const std::vector<InputEvent>& events, const SceneView& view);

  ViewOptions options;
  Camera camera;
  /// Why the hand and the session's keys do nothing here; empty: they do.
  std::string hands_off;
  /// A line for the screen, until the next key or press.
  void say(const std::string& line) { notice_ = line; }

  /// The probe held by the mouse.
  std::optional<std::size_t> held_probe() const;
  /// The press that goes on; nullptr: none.
  const SurfacePress* surface_press() const { return press_ ? &*press_ : nullptr; }
  /// Taken over from its script, held or not.
  bool taken(std::size_t probe) const { return taken_.contains(probe); }
  /// A line for the screen: why something is not done, or what was; empty if there is nothing to
  /// say.
  const std::string& notice() const { return notice_; }

 private:
  void press(const InputEvent& event, const SceneView& view);
  bool press_probe(const InputEvent& event, const SceneView& view);
  bool press_surface(const InputEvent& event, const SceneView& view);
  void move(const InputEvent& event);
  void wheel(const InputEvent& event);
  void let_go();
  void key(const std::string& name, Requests& requests, const SceneView& view);
  bool session_key(const std::string& name, Requests& requests);
  bool view_key(const std::string& name, const SceneView& view);
  void toggle_springs(std::size_t family, const SceneView& view);
  void toggle_tetrahedra(const SceneView& view);
  void move_cut(double by);
  void go_home(const SceneView& view);
  void give_back(const SceneView& view);
  bool may_take(std::size_t probe, const SceneView& view);
  std::optional<std::size_t> probe_to_press_with(const SceneView& view);
  void hold(const SceneView& view);

  std::vector<ProbeBody> bodies_;
  std::optional<ProbeDrag> drag_;
  std::optional<SurfacePress> press_;
  std::optional<SceneView> pressed_view_;  // as it was at the press: a dent moves no press
  std::map<std::size_t, Pose> taken_;      // where each is wanted
  std::optional<std::size_t> preferred_;   // presses where none is under the pointer
  Quat held_rotation_ = Quat::Identity();
  MouseButton camera_button_ = MouseButton::kNone;
  double last_x_ = 0, last_y_ = 0, press_x_ = 0, press_y_ = 0;
  std::string notice_;
};

}  // namespace palpate::visualizer
