#include "visualizer/interaction.h"

#include <cmath>

namespace palpate::visualizer {
namespace {

constexpr double kPixelsPerWheelStep = 15;
constexpr double kDepthPerWheelStep = 1e-3;  // [m]

template <class Device>
bool has_device(const ProbeView& probe) {
  return std::holds_alternative<Device>(probe.description.device);
}

/// A script or a recording yields to the mouse; who moves by themselves do not.
bool yields(const ProbeView& probe) {
  return has_device<scene::MouseDevice>(probe) || has_device<scene::ScriptedDevice>(probe) ||
         has_device<scene::TrajectoryDevice>(probe);
}

Pose pose_of(const ProbeView& probe) {
  if (probe.seen) return probe.pose;
  const auto* mouse = std::get_if<scene::MouseDevice>(&probe.description.device);
  return mouse ? Pose{mouse->start, mouse->rotation} : probe.pose;
}

}  // namespace

std::optional<std::size_t> Interaction::held_probe() const {
  if (press_) return press_->probe();
  return drag_ ? std::optional(drag_->probe()) : std::nullopt;
}

Requests Interaction::handle(const std::vector<InputEvent>& events, const SceneView& view) {
  Requests requests;
  for (const InputEvent& event : events) {
    switch (event.kind) {
      case InputEvent::Kind::kPress:
        press(event, view);
        break;
      case InputEvent::Kind::kMove:
        move(event);
        break;
      case InputEvent::Kind::kWheel:
        wheel(event);
        break;
      case InputEvent::Kind::kKey:
        key(event.key, requests, view);
        break;
      case InputEvent::Kind::kClose:
        requests.close = requests.end_run = true;
        break;
      case InputEvent::Kind::kRelease:
        let_go();
        break;
    }
  }
  hold(view);
  for (const auto& [probe, pose] : taken_) {
    ProbeState wanted;
    wanted.probe = static_cast<std::uint32_t>(probe);
    wanted.pose = pose;
    requests.probe_inputs.push_back(wanted);
  }
  return requests;
}

void Interaction::press(const InputEvent& event, const SceneView& view) {
  last_x_ = press_x_ = event.x;
  last_y_ = press_y_ = event.y;
  notice_.clear();
  if (event.x > camera.width) return;  // beside the 3-D part
  const bool hand = event.button == MouseButton::kLeft;
  if (hand && !hands_off.empty() && event.shift) notice_ = hands_off;
  if (hand && hands_off.empty()) {
    if (!event.shift && press_probe(event, view)) return;
    if (press_surface(event, view)) return;
    if (event.shift) notice_ = "No organ under the pointer: shift-drag presses one.";
    if (event.shift) return;
  }
  camera_button_ = event.shift ? MouseButton::kMiddle : event.button;
}

/// A probe under the pointer is dragged. @returns false if there is none
bool Interaction::press_probe(const InputEvent& event, const SceneView& view) {
  std::vector<Handle> handles;
  for (std::size_t i = 0; i < view.probes().size(); ++i) {
    // A probe not heard of yet is nowhere: behind the eye, so that it is not picked.
    const Vec3 nowhere = camera.position - camera.view_direction();
    const ProbeView& probe = view.probes()[i];
    const bool pickable = probe.seen && !bodies_.at(i).plane;
    handles.push_back({pickable ? probe.pose.position : nowhere, bodies_.at(i).reach});
  }
  const auto picked = pick(camera, handles, event.x, event.y);
  if (!picked) return false;
  if (!may_take(*picked, view)) return true;
  const Pose pose = pose_of(view.probes()[*picked]);
  drag_.emplace(*picked, pose.position);
  held_rotation_ = pose.rotation;
  preferred_ = picked;
  return true;
}

/// The organ under the pointer is pressed. @returns false if there is none
bool Interaction::press_surface(const InputEvent& event, const SceneView& view) {
  const auto place = pick_surface(view, camera, event.x, event.y);
  if (!place) return false;
  const auto probe = probe_to_press_with(view);
  if (!probe) return true;
  press_.emplace(*probe, bodies_.at(*probe), pose_of(view.probes()[*probe]), *place, view, camera);
  pressed_view_ = view;
  preferred_ = probe;
  return true;
}

bool Interaction::may_take(std::size_t probe, const SceneView& view) {
  const ProbeView& wanted = view.probes()[probe];
  if (yields(wanted)) return true;
  notice_ = "Probe '" + wanted.description.name + "' is moved by its own device, not by the mouse.";
  return false;
}

/// The one held last, else the first that follows the mouse, else the first that yields to it.
std::optional<std::size_t> Interaction::probe_to_press_with(const SceneView& view) {
  if (preferred_) return preferred_;
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < view.probes().size(); ++i) {
    if (has_device<scene::MouseDevice>(view.probes()[i])) return i;
    if (!first && yields(view.probes()[i])) first = i;
  }
  if (!first) {
    notice_ = view.probes().empty() ? "This scene has no probe to press with."
                                    : "Every probe of this scene is moved by its own device.";
  }
  return first;
}

void Interaction::move(const InputEvent& event) {
  const double dx = event.x - last_x_, dy = event.y - last_y_;
  last_x_ = event.x;
  last_y_ = event.y;
  if (press_) {
    if (event.control) {
      const auto place = pick_surface(*pressed_view_, camera, event.x, event.y);
      if (place) press_->slide_to(*place);
      press_x_ += dx;  // sliding drags nothing deeper
      press_y_ += dy;
    } else {
      const double away = (press_->place().point - camera.position).dot(camera.view_direction());
      const double pixels = std::hypot(event.x - press_x_, event.y - press_y_);
      press_->drag(pixels * camera.pixel_size(away));
      notice_ = press_->deepest() ? "As deep as the mouse goes." : "";
    }
  } else if (drag_) {
    if (event.control) {
      drag_->along_view(camera, dy);
    } else {
      drag_->in_picture_plane(camera, dx, dy);
    }
  } else if (camera_button_ == MouseButton::kLeft) {
    orbit(camera, dx, dy);
  } else if (camera_button_ == MouseButton::kMiddle) {
    pan(camera, dx, dy);
  } else if (camera_button_ == MouseButton::kRight) {
    zoom(camera, dy / kPixelsPerWheelStep);
  }
}

void Interaction::wheel(const InputEvent& event) {
  if (press_) {
    press_->deepen(event.wheel_steps * kDepthPerWheelStep);
  } else if (drag_) {
    drag_->along_view(camera, event.wheel_steps * kPixelsPerWheelStep);
  } else {
    zoom(camera, event.wheel_steps);
  }
}

/// A press ends off the organ; a dragged probe stays where it was put.
void Interaction::let_go() {
  if (press_) taken_[press_->probe()] = press_->stood_off();
  press_.reset();
  pressed_view_.reset();
  drag_.reset();
  camera_button_ = MouseButton::kNone;
}

/// Where the held probe is wanted now.
void Interaction::hold(const SceneView& view) {
  if (press_) {
    taken_[press_->probe()] = press_->wanted(pose_of(view.probes()[press_->probe()]).position);
  }
  if (drag_) taken_[drag_->probe()] = {drag_->position(), held_rotation_};
}

/// Silence gives a script its probe back; one that has no script goes where it began.
void Interaction::give_back(const SceneView& view) {
  let_go();
  notice_ = taken_.empty() ? "No probe is taken over: there is none to give back." : "Given back: ";
  std::string names;
  for (const auto& [probe, pose] : taken_) {
    if (!names.empty()) names += ", ";
    names += view.probes()[probe].description.name;
  }
  notice_ += names;
  std::erase_if(taken_, [&](const auto& taken) {
    return !has_device<scene::MouseDevice>(view.probes()[taken.first]);
  });
  for (auto& [probe, pose] : taken_) {
    const auto& mouse = std::get<scene::MouseDevice>(view.probes()[probe].description.device);
    pose = {mouse.start, mouse.rotation};
  }
  preferred_.reset();
}

}  // namespace palpate::visualizer
