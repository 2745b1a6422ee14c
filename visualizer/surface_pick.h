// Where lines and points meet the organs as they are shown.
#pragma once

#include <optional>
#include <span>

#include "visualizer/camera.h"
#include "visualizer/scene_view.h"

namespace palpate::visualizer {

struct SurfacePoint {
  std::size_t organ = 0;
  Vec3 point = Vec3::Zero();   ///< in W [m]
  Vec3 normal = Vec3::Zero();  ///< of its triangle, unit, outward
};

/// The first point of an organ's surface on the way from `from` to `to`, in W [m].
std::optional<SurfacePoint> first_on_way(const SceneView& view, const Vec3& from, const Vec3& to);

/// What is seen of the organs at a pixel.
std::optional<SurfacePoint> pick_surface(const SceneView& view, const Camera& camera, double x,
                                         double y);

/// The point of the organs below `p` [m]: on the triangles about the node nearest to it.
std::optional<SurfacePoint> foot_on_surface(const SceneView& view, const Vec3& p);

}  // namespace palpate::visualizer
