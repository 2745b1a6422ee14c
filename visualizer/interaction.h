// Keys and mouse → view options, camera, dragged probes, session commands. No window needed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "visualizer/camera.h"
#include "visualizer/probe_drag.h"
#include "visualizer/scene_view.h"
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

/// Requests of the person that others have to carry out.
struct Requests {
  bool close = false, screenshot = false, pause_or_resume = false, reset = false;
  std::optional<ProbeState> probe_input;  ///< pose of the held probe; header is the sender's
};

class Interaction {
 public:
  /// @param reaches  of each probe's surface from its origin, at most [m]
  explicit Interaction(std::vector<double> reaches) : reaches_(std::move(reaches)) {}

  /// Carries out what concerns the picture; returns the rest.
  Requests handle(const std::vector<InputEvent>& events, const SceneView& view);

  ViewOptions options;
  Camera camera;

  /// The probe held by the mouse.
  std::optional<std::size_t> held_probe() const;
  /// A line for the screen when a drag is refused; empty if all is well.
  const std::string& notice() const { return notice_; }

 private:
  void press(const InputEvent& event, const SceneView& view);
  void move(const InputEvent& event);
  void wheel(const InputEvent& event);
  void key(const std::string& name, Requests& requests);
  void take_probe(std::size_t probe, const SceneView& view);
  void request_held(Requests& requests) const;

  std::vector<double> reaches_;
  std::optional<ProbeDrag> drag_;
  Quat held_rotation_ = Quat::Identity();
  MouseButton camera_button_ = MouseButton::kNone;
  double last_x_ = 0, last_y_ = 0;
  std::string notice_;
};

/// Index of the scene's first probe whose device is `mouse`.
std::optional<std::size_t> first_mouse_probe(const SceneView& view);

}  // namespace palpate::visualizer
