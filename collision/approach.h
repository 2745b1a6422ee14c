// How a probe comes to organs that do not move: what can be said of a scene before it is run.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "modules/core/types.h"
#include "modules/geometry/probe_form.h"
#include "modules/geometry/triangle_surface.h"

namespace palpate::collision {

struct Approach {
  bool begins_inside = false;        ///< of an organ
  std::optional<double> touches_at;  ///< first touch [s]; none: not in the time looked at
  double nearest = 0;                ///< least distance of the probe's origin to a surface [m]
  double nearest_at = 0;             ///< when [s]
  double fastest = 0;                ///< speed of its origin, mean over kLookEvery [m/s]
  double extent = 0;                 ///< longest side of the box its origin stays in [m]
  double duration = 0;               ///< looked at [s]
};

inline constexpr double kLookEvery = 0.01;  ///< [s]; between two looks the motion is swept

/// @param surfaces  closed, in W [m]
/// @param pose_at   of the probe at a time [s], which rises from call to call
/// @param duration  how far to look, >= 0 [s]
Approach approach_of(const geometry::ProbeForm& probe,
                     const std::vector<geometry::TriangleSurface>& surfaces,
                     const std::function<Pose(double)>& pose_at, double duration);

}  // namespace palpate::collision
