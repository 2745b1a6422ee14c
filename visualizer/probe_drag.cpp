#include "visualizer/probe_drag.h"

#include <algorithm>
#include <cmath>

namespace palpate::visualizer {
namespace {

constexpr double kNearestDepth = 0.02;  // the eye is not passed [m]

}  // namespace

std::optional<std::size_t> pick(const Camera& camera, const std::vector<Handle>& handles, double x,
                                double y, double margin) {
  std::optional<std::size_t> picked;
  double nearest = 0;
  for (std::size_t i = 0; i < handles.size(); ++i) {
    const auto pixel = project(camera, handles[i].center);
    if (!pixel) continue;
    const double radius = handles[i].radius / camera.pixel_size(pixel->depth) + margin;
    if (std::hypot(x - pixel->x, y - pixel->y) > radius) continue;
    if (!picked || pixel->depth < nearest) {
      picked = i;
      nearest = pixel->depth;
    }
  }
  return picked;
}

void ProbeDrag::in_picture_plane(const Camera& camera, double dx_pixels, double dy_pixels) {
  auto pixel = project(camera, position_);
  if (!pixel) return;
  pixel->x += dx_pixels;
  pixel->y += dy_pixels;
  position_ = unproject(camera, *pixel);
}

void ProbeDrag::along_view(const Camera& camera, double pixels) {
  const double depth = (position_ - camera.position).dot(camera.view_direction());
  if (!(depth > 0)) return;
  const double wanted = depth + pixels * camera.pixel_size(depth);
  position_ += (std::max(wanted, kNearestDepth) - depth) * camera.view_direction();
}

}  // namespace palpate::visualizer
