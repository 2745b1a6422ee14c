#include "visualizer/interaction.h"

namespace palpate::visualizer {
namespace {

constexpr double kPixelsPerWheelStep = 15;

bool follows_mouse(const ProbeView& probe) {
  return std::holds_alternative<scene::MouseDevice>(probe.description.device);
}

}  // namespace

std::optional<std::size_t> first_mouse_probe(const SceneView& view) {
  for (std::size_t i = 0; i < view.probes().size(); ++i) {
    if (follows_mouse(view.probes()[i])) return i;
  }
  return std::nullopt;
}

std::optional<std::size_t> Interaction::held_probe() const {
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
        key(event.key, requests);
        break;
      case InputEvent::Kind::kClose:
        requests.close = true;
        break;
      case InputEvent::Kind::kRelease:
        drag_.reset();
        camera_button_ = MouseButton::kNone;
        break;
    }
  }
  if (drag_) request_held(requests);
  return requests;
}

void Interaction::press(const InputEvent& event, const SceneView& view) {
  last_x_ = event.x;
  last_y_ = event.y;
  notice_.clear();
  if (event.x > camera.width) return;  // beside the 3-D part
  if (event.button == MouseButton::kLeft) {
    std::vector<Handle> handles;
    for (std::size_t i = 0; i < view.probes().size(); ++i) {
      // A probe not heard of yet is nowhere: behind the eye, so that it is not picked.
      const Vec3 nowhere = camera.position - camera.view_direction();
      const ProbeView& probe = view.probes()[i];
      handles.push_back({probe.seen ? probe.pose.position : nowhere, reaches_.at(i)});
    }
    if (const auto picked = pick(camera, handles, event.x, event.y)) {
      return take_probe(*picked, view);
    }
    if (event.shift) {
      if (const auto probe = first_mouse_probe(view)) return take_probe(*probe, view);
      notice_ = "No probe of this scene has the device 'mouse': none follows it.";
      return;
    }
  }
  camera_button_ = event.shift ? MouseButton::kMiddle : event.button;
}

void Interaction::take_probe(std::size_t probe, const SceneView& view) {
  const ProbeView& taken = view.probes()[probe];
  if (!follows_mouse(taken)) {
    notice_ = "Probe '" + taken.description.name +
              "' does not follow the mouse: its device is not 'mouse'.";
    return;
  }
  const auto& device = std::get<scene::MouseDevice>(taken.description.device);
  const Pose start{device.start, device.rotation};
  const Pose& pose = taken.seen ? taken.pose : start;
  drag_.emplace(probe, pose.position);
  held_rotation_ = pose.rotation;
}

void Interaction::move(const InputEvent& event) {
  const double dx = event.x - last_x_, dy = event.y - last_y_;
  last_x_ = event.x;
  last_y_ = event.y;
  if (drag_) {
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
  if (drag_) {
    drag_->along_view(camera, event.wheel_steps * kPixelsPerWheelStep);
  } else {
    zoom(camera, event.wheel_steps);
  }
}

void Interaction::request_held(Requests& requests) const {
  ProbeState wanted;
  wanted.probe = static_cast<std::uint32_t>(drag_->probe());
  wanted.pose = {drag_->position(), held_rotation_};
  requests.probe_input = wanted;
}

void Interaction::key(const std::string& name, Requests& requests) {
  if (name == "h") options.help = !options.help;
  if (name == "c") {
    options.coloring =
        options.coloring == Coloring::kStrain ? Coloring::kDisplacement : Coloring::kStrain;
  }
  if (name == "1" || name == "2" || name == "3") {
    bool& family = options.springs[static_cast<std::size_t>(name[0] - '1')];
    family = !family;
  }
  if (name == "s") requests.screenshot = true;
  if (name == "space") requests.pause_or_resume = true;
  if (name == "r") requests.reset = true;
  if (name == "q" || name == "Escape") requests.close = true;
}

}  // namespace palpate::visualizer
