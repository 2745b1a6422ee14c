// A ball drawn off-screen, and questions about the pixels.
#pragma once

#include <vector>

#include "modules/geometry/primitives.h"
#include "tests/visualizer/fake_session.h"
#include "visualizer/offscreen_display.h"
#include "visualizer/renderer.h"

namespace palpate::visualizer::testing {

inline constexpr int kWidth = 640, kHeight = 400;

struct Picture {
  std::vector<std::uint8_t> pixels;

  Rgb at(double x, double y) const {
    const std::size_t i = 3 * (std::size_t(y) * kWidth + std::size_t(x));
    return {pixels[i], pixels[i + 1], pixels[i + 2]};
  }
  std::size_t differing(const Picture& other) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < pixels.size(); i += 3) {
      count += pixels[i] != other.pixels[i] || pixels[i + 1] != other.pixels[i + 1] ||
               pixels[i + 2] != other.pixels[i + 2];
    }
    return count;
  }
};

/// A ball of 5 cm about the origin, seen off-screen from the front.
struct Studio {
  OffscreenDisplay display;
  scene::Scene scene = two_probe_scene();
  SceneView view{scene};
  SurfaceTopology topology = topology_of(geometry::make_ball(0.05, 3));
  Interaction interaction{{0.01, 0.036}};
  Layout layout = make_layout(kWidth, kHeight);
  Renderer renderer{{kWidth, kHeight, false, "test"},
                    {geometry::surface_of(scene::form_of(scene.probes[0].shape), 1),
                     geometry::surface_of(scene::form_of(scene.probes[1].shape), 1)}};

  Studio() {
    interaction.camera =
        frontal_camera(Vec3::Zero(), 0.12, int(layout.scene.width), int(layout.scene.height));
    view.receive(topology);
  }

  Picture draw(bool overlay = false) {
    view.refresh();
    const DrawList list = make_draw_list(view, interaction.options);
    renderer.draw(list, overlay ? make_overlay(view, list, interaction, layout, 1) : Overlay{},
                  interaction.camera);
    return {renderer.pixels()};
  }
  /// The background: the organ is far behind the eye.
  Picture draw_nothing() {
    Camera away = interaction.camera;
    away.target = away.position + (away.position - away.target);
    renderer.draw(make_draw_list(view, {}), Overlay{}, away);
    return {renderer.pixels()};
  }
  void move_ball(const Vec3& by) {
    auto positions = positions_of(topology, 1);
    for (std::size_t i = 0; i < positions.positions.size(); ++i) {
      positions.positions[i] += static_cast<float>(by[static_cast<int>(i % 3)]);
    }
    view.receive(positions, 1);
  }
  Pixel pixel_of(const Vec3& p) const { return *project(interaction.camera, p); }
};

}  // namespace palpate::visualizer::testing
