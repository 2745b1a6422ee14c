#include "visualizer/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::visualizer {

Vec3 Camera::view_direction() const { return (target - position).normalized(); }

Vec3 Camera::right() const { return view_direction().cross(up).normalized(); }

Vec3 Camera::screen_up() const { return right().cross(view_direction()); }

double Camera::pixel_size(double depth) const {
  return 2 * depth * std::tan(0.5 * view_angle) / height;
}

std::optional<Pixel> project(const Camera& camera, const Vec3& p_W) {
  const Vec3 from_eye = p_W - camera.position;
  const double depth = from_eye.dot(camera.view_direction());
  if (!(depth > 1e-6)) return std::nullopt;
  const double size = camera.pixel_size(depth);
  return Pixel{0.5 * camera.width + from_eye.dot(camera.right()) / size,
               0.5 * camera.height + from_eye.dot(camera.screen_up()) / size, depth};
}

Vec3 unproject(const Camera& camera, const Pixel& pixel) {
  const double size = camera.pixel_size(pixel.depth);
  return camera.position + pixel.depth * camera.view_direction() +
         (pixel.x - 0.5 * camera.width) * size * camera.right() +
         (pixel.y - 0.5 * camera.height) * size * camera.screen_up();
}

Camera frontal_camera(const Vec3& center, double radius, int width, int height) {
  Camera camera;
  camera.width = std::max(1, width);
  camera.height = std::max(1, height);
  const double half_vertical = 0.5 * camera.view_angle;
  const double aspect = double(camera.width) / camera.height;
  const double half = std::min(half_vertical, std::atan(aspect * std::tan(half_vertical)));
  camera.target = center;
  camera.position = center - Vec3::UnitY() * radius / std::sin(half);
  return camera;
}

void orbit(Camera& camera, double dx_pixels, double dy_pixels) {
  const double per_pixel = std::numbers::pi / camera.height;
  const Vec3 arm = camera.position - camera.target;
  const Vec3 turned = Eigen::AngleAxisd(-dx_pixels * per_pixel, camera.up) *
                      (Eigen::AngleAxisd(dy_pixels * per_pixel, camera.right()) * arm);
  // Over the pole the picture would flip.
  const Vec3 turned_direction = turned.normalized();
  if (std::abs(turned_direction.dot(camera.up)) > 0.99) return;
  camera.position = camera.target + turned;
}

void pan(Camera& camera, double dx_pixels, double dy_pixels) {
  const double size = camera.pixel_size((camera.target - camera.position).norm());
  const Vec3 shift = -size * (dx_pixels * camera.right() + dy_pixels * camera.screen_up());
  camera.position += shift;
  camera.target += shift;
}

void zoom(Camera& camera, double steps) {
  const Vec3 arm = camera.position - camera.target;
  const double factor = std::clamp(std::pow(0.9, steps), 0.1, 10.0);
  if (factor * arm.norm() > 0.01) camera.position = camera.target + factor * arm;
}

}  // namespace palpate::visualizer
