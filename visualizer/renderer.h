// Draws a draw list and an overlay into a window or, without one, into memory. With scene_actors
// and overlay_actor the only user of VTK.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "modules/geometry/triangle_surface.h"
#include "visualizer/camera.h"
#include "visualizer/draw_list.h"
#include "visualizer/interaction.h"
#include "visualizer/overlay.h"

namespace palpate::visualizer {

struct RendererOptions {
  int width = 1280, height = 720;  ///< [pixels]
  bool window = true;              ///< false: draws into memory only
  std::string title = "Palpate";
};

class Renderer {
 public:
  /// @param probe_surfaces  one per probe of the scene, in its own frame, see
  /// geometry::surface_of() Needs an X display (DISPLAY), see OffscreenDisplay.
  Renderer(const RendererOptions& options, std::vector<geometry::TriangleSurface> probe_surfaces);
  ~Renderer();

  void draw(const DrawList& list, const Overlay& overlay, const Camera& camera);

  /// Size of the drawing area now; a person may have resized the window [pixels].
  int width() const;
  int height() const;

  /// Events in the window since the last call.
  std::vector<InputEvent> take_events();

  /// Writes the picture drawn last; whole file or nothing.
  /// @throws std::runtime_error if it cannot be written
  void write_png(const std::filesystem::path& file);

  /// The picture drawn last: 3 bytes per pixel, rows from the bottom up (width × height × 3).
  std::vector<std::uint8_t> pixels();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::visualizer
