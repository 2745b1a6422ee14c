#include "modules/scene/region.h"

#include <algorithm>

namespace palpate::scene {

double distance(const Region& region, const Vec3& x) {
  if (const auto* sphere = std::get_if<SphereRegion>(&region)) {
    return std::max(0.0, (x - sphere->center).norm() - sphere->radius);
  }
  const auto& box = std::get<BoxRegion>(region);
  return (x - x.cwiseMax(box.min).cwiseMin(box.max)).norm();
}

bool contains(const Region& region, const Vec3& x) { return distance(region, x) == 0; }

}  // namespace palpate::scene
