#include "collision/probe_solid.h"

#include <algorithm>
#include <cmath>

#include "modules/core/tolerances.h"

namespace palpate::collision {
namespace {

class HalfSpace final : public ProbeSolid {
 public:
  std::optional<SolidPoint> nearest(const Vec3& x, double within) const override {
    if (x[2] > within) return {};
    return SolidPoint{{x[0], x[1], 0}, Vec3::UnitZ(), x[2], true};
  }
  std::optional<SolidEntry> entry(const Vec3& start, const Vec3& end, double) const override {
    if (start[2] <= 0 || end[2] > 0) return {};
    const double time = start[2] / (start[2] - end[2]);
    return SolidEntry{time, start + time * (end - start), Vec3::UnitZ()};
  }
  bool shadows(const Vec3& x, const Vec3& direction) const override {
    return x[2] <= 0 || direction[2] < 0;
  }
};

class BoxSolid final : public ProbeSolid {
 public:
  explicit BoxSolid(const Vec3& half) : half_(half) {}

  std::optional<SolidPoint> nearest(const Vec3& x, double within) const override {
    const Vec3 inside = x.cwiseMax(-half_).cwiseMin(half_);
    SolidPoint result{inside, Vec3::Zero(), (x - inside).norm(), false};
    if (result.distance > kDirectionless) {
      result.outward = (x - inside) / result.distance;
    } else {
      int axis = 0;
      (half_ - x.cwiseAbs()).minCoeff(&axis);
      result.outward[axis] = x[axis] < 0 ? -1 : 1;
      result.point[axis] = result.outward[axis] * half_[axis];
      result.distance = std::abs(x[axis]) - half_[axis];
    }
    if (result.distance > within) return {};
    return result;
  }

  std::optional<SolidEntry> entry(const Vec3& start, const Vec3& end,
                                  double separation) const override {
    SolidEntry result{-1, Vec3::Zero(), Vec3::Zero()};
    if (!clip(start, end - start, 1, separation, result) || result.outward == Vec3::Zero()) {
      return {};
    }
    result.point = start + result.time * (end - start);
    return result;
  }

  bool shadows(const Vec3& x, const Vec3& direction) const override {
    SolidEntry entry;
    return clip(x, direction, 1e9, 0, entry);
  }

 private:
  /// Slab test. `entry.outward` stays zero where the way starts inside.
  bool clip(const Vec3& start, const Vec3& way, double longest, double separation,
            SolidEntry& entry) const {
    double from = 0, to = longest;
    entry.outward = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const double half = half_[axis] + separation;
      if (way[axis] == 0) {
        if (std::abs(start[axis]) > half) return false;
        continue;
      }
      const double sign = way[axis] > 0 ? 1 : -1;
      const double in = std::max(0.0, (-sign * half - start[axis]) / way[axis]);
      const double out = (sign * half - start[axis]) / way[axis];
      if (in >= from && -sign * start[axis] >= half_[axis]) {
        from = in;
        entry.outward = -sign * Vec3::Unit(axis);
      }
      to = std::min(to, out);
      if (from > to) return false;
    }
    entry.time = from;
    return true;
  }

  Vec3 half_;
};

}  // namespace

std::unique_ptr<ProbeSolid> make_half_space() { return std::make_unique<HalfSpace>(); }

std::unique_ptr<ProbeSolid> make_box_solid(const Vec3& size) {
  return std::make_unique<BoxSolid>(0.5 * size);
}

}  // namespace palpate::collision
