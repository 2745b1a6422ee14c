// Reproducible random points, triangles and deformed balls for the tests of collision/.
#pragma once

#include <random>

#include "modules/geometry/closest_points.h"
#include "modules/geometry/primitives.h"

namespace palpate::collision {

class RandomShapes {
 public:
  explicit RandomShapes(unsigned seed) : engine_(seed) {}

  double number(double low, double high) {
    // Not std::uniform_real_distribution: its sequence depends on the library.
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  Vec3 point(double extent) {
    const double x = number(-extent, extent), y = number(-extent, extent);
    return {x, y, number(-extent, extent)};
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 p = point(1);
      if (p.norm() > 0.1 && p.norm() < 1) return p.normalized();
    }
  }
  Quat rotation() { return Quat(Eigen::AngleAxisd(number(0, 3), direction())); }
  geometry::TriangleCorners triangle(double extent) {
    return {point(extent), point(extent), point(extent)};
  }

  /// A ball with smooth dents and bulges of up to a tenth of its radius.
  geometry::TriangleSurface deformed_ball(double radius, int levels) {
    geometry::TriangleSurface ball = geometry::make_ball(radius, levels);
    const Vec3 wave = 2 * direction() / radius, other = 3 * direction() / radius;
    for (Vec3& x : ball.nodes)
      x *= 1 + 0.05 * std::sin(wave.dot(x)) + 0.05 * std::cos(other.dot(x));
    return ball;
  }

 private:
  std::mt19937 engine_;
};

}  // namespace palpate::collision
