#include "haptics/pressed_work.h"

#include <algorithm>
#include <cmath>

namespace palpate::haptics {
namespace {

/// How far it goes against `force` [m].
double way_against(const Vec3& force, const Vec3& moved) {
  const double strength = force.stableNorm();
  return strength > 0 ? -force.dot(moved) / strength : 0;
}

}  // namespace

void PressedWork::clear(const Vec3& position) {
  *this = {};
  at_ = position;
}

void PressedWork::move(const Vec3& position, const Vec3& force, const Vec3& pressing) {
  const Vec3 moved = position - at_;
  at_ = position;
  strength_ = force.stableNorm();
  way_ = std::max(0.0, way_ + way_against(force, moved));
  const double in = way_against(pressing, moved);
  if (!std::isfinite(depth_ + in)) return;
  in > 0 ? press(in, pressing.stableNorm()) : release(-in);
}

void PressedWork::press(double by, double force) {
  widen(depth_ + by);
  while (depth_of(knot_ + 1) <= depth_ + by) {
    ++knot_;
    works_[knot_] = work_ + force * (depth_of(knot_) - depth_);
  }
  depth_ += by;
  work_ += force * by;
}

/// Back along the curve, which is straight between knots.
void PressedWork::release(double by) {
  const double to = std::max(0.0, depth_ - by);
  while (knot_ > 0 && depth_of(knot_) > to) {
    depth_ = depth_of(knot_);
    work_ = works_[knot_];
    --knot_;
  }
  const double below = depth_of(knot_);
  if (depth_ > below) {
    work_ = works_[knot_] + (to - below) / (depth_ - below) * (work_ - works_[knot_]);
  }
  depth_ = to;
}

/// So that a depth lies between knots: every second one is left.
void PressedWork::widen(double depth) {
  while (depth >= depth_of(kKnots - 1)) {
    for (std::size_t k = 1; 2 * k < kKnots; ++k) works_[k] = works_[2 * k];
    width_ *= 2;
    knot_ /= 2;
  }
}

double PressedWork::returnable() const { return std::max(strength_ * way_ / 2, work_); }

}  // namespace palpate::haptics
