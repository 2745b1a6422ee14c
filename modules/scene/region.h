// Where a region of a scene is.
#pragma once

#include "modules/scene/scene.h"

namespace palpate::scene {

/// Of x from the region, 0 in it and on its border [m].
double distance(const Region& region, const Vec3& x);
bool contains(const Region& region, const Vec3& x);

}  // namespace palpate::scene
