// Where a probe on its way touches a surface at rest.
#pragma once

#include <vector>

#include "modules/geometry/probe_form.h"
#include "modules/scene/scene.h"

namespace palpate::scene {

struct Touch {
  Vec3 place = Vec3::Zero(), outward = Vec3::UnitZ();  ///< on the skin, and its normal there
  double depth = 0;  ///< of the probe in what it touches [m]; below 0: apart
};

/// @param probe  in W, as the skin
Touch touch_of(const geometry::TriangleSurface& skin, const geometry::RoundedSegment& probe);

/// Adds a ball of the probe's radius about the place it touches, if it does and none is near by.
void add_touched(const geometry::TriangleSurface& skin, const geometry::RoundedSegment& probe,
                 std::vector<SphereRegion>& balls);

}  // namespace palpate::scene
