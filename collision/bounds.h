// Axis-aligned boxes.
#pragma once

#include <algorithm>

#include "modules/geometry/surface_blocks.h"

namespace palpate::collision {

/// Axis-aligned box [m]; empty until something is added.
struct Bounds {
  Vec3 lower = Vec3::Constant(1e300), upper = Vec3::Constant(-1e300);

  void add(const Vec3& p) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  void add(const geometry::BlockBox& box) {
    for (int k = 0; k < 3; ++k) {
      lower[k] = std::min<double>(lower[k], box.lower[k]);
      upper[k] = std::max<double>(upper[k], box.upper[k]);
    }
  }
  void inflate(double by) {
    lower.array() -= by;
    upper.array() += by;
  }
  bool overlaps(const Bounds& other) const {
    return (lower.array() <= other.upper.array()).all() &&
           (other.lower.array() <= upper.array()).all();
  }
  bool overlaps(const geometry::BlockBox& other) const {
    bool all = true;  // without branches: most boxes are far away along some axis
    for (int k = 0; k < 3; ++k) {
      all &= lower[k] <= double{other.upper[k]} && double{other.lower[k]} <= upper[k];
    }
    return all;
  }
  /// 0 where they overlap [m²].
  double squared_distance(const Bounds& other) const {
    return (lower - other.upper).cwiseMax(other.lower - upper).cwiseMax(0).squaredNorm();
  }
  double squared_distance(const geometry::BlockBox& other) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const double apart =
          std::max({lower[k] - double{other.upper[k]}, double{other.lower[k]} - upper[k], 0.0});
      sum += apart * apart;
    }
    return sum;
  }
};

}  // namespace palpate::collision
