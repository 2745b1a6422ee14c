#include "modules/core/touch.h"

#include <algorithm>

namespace palpate {

bool LocalLaw::touching() const {
  return std::ranges::any_of(rows, [](const LawRow& row) { return row.force.dot(row.normal) > 0; });
}

Vec3 LocalLaw::force() const {
  Vec3 sum = Vec3::Zero();
  for (const LawRow& row : rows) sum += row.force;
  return sum;
}

Vec3 LocalLaw::torque() const {
  Vec3 sum = Vec3::Zero();
  for (const LawRow& row : rows) sum += (anchor.rotation * row.point_P).cross(row.force);
  return sum;
}

Mat3 contact_basis(const Vec3& normal) {
  Mat3 basis;
  basis.col(0) = normal;
  basis.col(1) = normal.unitOrthogonal();
  basis.col(2) = normal.cross(basis.col(1));
  return basis;
}

}  // namespace palpate
