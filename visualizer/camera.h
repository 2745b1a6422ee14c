// A perspective camera as plain numbers: projection, and how the mouse moves it.
//
// Pixels: x to the right, y up, origin at the lower left of the view (VTK's convention).
// Depth: distance from the eye along the view direction [m].
#pragma once

#include <optional>
#include <utility>

#include "modules/core/types.h"

namespace palpate::visualizer {

struct Camera {
  Vec3 position = Vec3(0, -0.5, 0);  ///< eye, in W [m]
  Vec3 target = Vec3::Zero();        ///< in W [m]; not the position
  Vec3 up = Vec3::UnitZ();           ///< unit, not along the view direction
  double view_angle = 0.45;          ///< full vertical opening [rad]
  int width = 940, height = 720;     ///< of the view [pixels]

  Vec3 view_direction() const;  ///< unit, into the picture
  Vec3 right() const;           ///< unit, in W
  Vec3 screen_up() const;       ///< unit, in W, perpendicular to the view direction
  /// Metres per pixel in the plane at this depth.
  double pixel_size(double depth) const;
};

struct Pixel {
  double x = 0, y = 0;
  double depth = 0;  ///< [m]
};

/// Place of a point in the window; empty if it is not in front of the eye.
std::optional<Pixel> project(const Camera& camera, const Vec3& p_W);

/// The point seen at a pixel at that depth, in W.
Vec3 unproject(const Camera& camera, const Pixel& pixel);

/// Looks along +y (frontal) from as far as shows the whole ball of `radius` about `center`.
Camera frontal_camera(const Vec3& center, double radius, int width, int height);

void orbit(Camera& camera, double dx_pixels, double dy_pixels);  ///< about the target
void pan(Camera& camera, double dx_pixels, double dy_pixels);    ///< the target follows the mouse
void zoom(Camera& camera, double steps);  ///< one step = a tenth nearer (positive) or further

}  // namespace palpate::visualizer
