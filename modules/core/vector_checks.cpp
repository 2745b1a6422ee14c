#include "modules/core/vector_checks.h"

#include <cmath>

namespace palpate {

bool is_longer_than(const Vec3& v, double limit) {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return false;
  // The vector is scaled by its largest component so that squares neither overflow nor vanish.
  return (v / largest).norm() > limit / largest;
}

Vec3 clamp_length(const Vec3& v, double limit) {
  if (!is_longer_than(v, limit)) return v;
  const Vec3 scaled = v / v.cwiseAbs().maxCoeff();
  return scaled * (limit / scaled.norm());
}

}  // namespace palpate
