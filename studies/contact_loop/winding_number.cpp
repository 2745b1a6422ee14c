#include "studies/contact_loop/winding_number.h"

#include <cmath>
#include <numbers>

namespace palpate::contact_loop {

double winding_number(const Vec3& p, std::span<const float> positions,
                      std::span<const geometry::Triangle> triangles) {
  double solid_angle = 0;
  for (const geometry::Triangle& t : triangles) {
    Vec3 r[3];
    for (std::size_t k = 0; k < 3; ++k) {
      r[k] = Eigen::Map<const Eigen::Vector3f>(&positions[3 * t[k]]).cast<double>() - p;
    }
    const double n0 = r[0].norm(), n1 = r[1].norm(), n2 = r[2].norm();
    const double below =
        n0 * n1 * n2 + r[0].dot(r[1]) * n2 + r[0].dot(r[2]) * n1 + r[1].dot(r[2]) * n0;
    solid_angle += 2 * std::atan2(r[0].dot(r[1].cross(r[2])), below);
  }
  return solid_angle / (4 * std::numbers::pi);
}

}  // namespace palpate::contact_loop
