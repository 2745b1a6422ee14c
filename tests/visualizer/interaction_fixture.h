// A person at the window of a made-up session.
#pragma once

#include "modules/geometry/primitives.h"
#include "tests/visualizer/fake_session.h"
#include "visualizer/interaction.h"

namespace palpate::visualizer::testing {

using Kind = InputEvent::Kind;

/// A scene whose probes are 6 cm left (scripted) and right (mouse) of the middle.
struct Fixture {
  SceneView view;
  Interaction interaction{{0.01, 0.036}};

  explicit Fixture(const scene::Scene& scene = two_probe_scene()) : view(scene) {
    ProbeState probe;
    for (const double side : {-1, 1}) {
      probe.pose.position = Vec3(0.06 * side, 0, 0);
      probe.pose.rotation = Eigen::AngleAxisd(0.3 * side, Vec3::UnitX());
      view.receive(probe);
      probe.probe = 1;
    }
    interaction.camera = frontal_camera(Vec3::Zero(), 0.12, 900, 700);
  }

  /// An organ in the middle of the picture.
  void add_ball() { view.receive(topology_of(geometry::make_ball(0.03, 3))); }
  Pixel pixel_of(std::size_t probe) const {
    return *project(interaction.camera, view.probes()[probe].pose.position);
  }
  Requests send(Kind kind, double x, double y, bool shift = false, bool control = false,
                MouseButton button = MouseButton::kLeft) {
    InputEvent event;
    event.kind = kind;
    event.x = x;
    event.y = y;
    event.shift = shift;
    event.control = control;
    event.button = button;
    return interaction.handle({event}, view);
  }
  Requests key(const std::string& name) {
    InputEvent event;
    event.kind = Kind::kKey;
    event.key = name;
    return interaction.handle({event}, view);
  }
};

}  // namespace palpate::visualizer::testing
