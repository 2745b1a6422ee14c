// Drags probes with the mouse: finds the one under the cursor and where a drag moves it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "modules/core/types.h"
#include "visualizer/camera.h"

namespace palpate::visualizer {

/// A ball that is grabbed with the mouse.
struct Handle {
  Vec3 center = Vec3::Zero();  ///< in W [m]
  double radius = 0.01;        ///< [m]
};

/// The nearest handle seen at the pixel, with `margin` pixels of tolerance around each.
std::optional<std::size_t> pick(const Camera& camera, const std::vector<Handle>& handles, double x,
                                double y, double margin = 6);

/// One probe being dragged. Movements are exact: the point taken stays under the cursor.
class ProbeDrag {
 public:
  /// @param position  of the probe's origin, in W [m]
  ProbeDrag(std::size_t probe, const Vec3& position) : probe_(probe), position_(position) {}

  /// Moves in the plane through the probe that is parallel to the picture.
  void in_picture_plane(const Camera& camera, double dx_pixels, double dy_pixels);
  /// Moves along the line of sight; `pixels` of mouse travel up push it away as far as the same
  /// travel would move it sideways.
  void along_view(const Camera& camera, double pixels);

  std::size_t probe() const { return probe_; }
  const Vec3& position() const { return position_; }

 private:
  std::size_t probe_;
  Vec3 position_;
};

}  // namespace palpate::visualizer
