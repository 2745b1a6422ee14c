// The box along the axes that holds points.
#pragma once

#include <Eigen/Geometry>
#include <span>

#include "modules/core/types.h"

namespace palpate::geometry {

/// Empty without points [m].
inline Eigen::AlignedBox3d bounding_box(std::span<const Vec3> points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& point : points) box.extend(point);
  return box;
}

}  // namespace palpate::geometry
