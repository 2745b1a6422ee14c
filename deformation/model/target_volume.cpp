#include "deformation/model/target_volume.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::deformation {
namespace {

/// Smoothest way from 0 to 1 that begins and ends at rest (minimum jerk).
double minimum_jerk(double s) { return s * s * s * (10 + s * (6 * s - 15)); }

double curve(const std::vector<scene::Filling::Point>& points, double time) {
  if (points.empty()) return 1;
  const auto next = std::upper_bound(points.begin(), points.end(), time,
                                     [](double t, const auto& point) { return t < point.time; });
  if (next == points.begin()) return points.front().ratio;
  if (next == points.end()) return points.back().ratio;
  const auto& from = *(next - 1);
  const double s = (time - from.time) / (next->time - from.time);
  return from.ratio + (next->ratio - from.ratio) * minimum_jerk(s);
}

}  // namespace

double TargetVolume::asked(const scene::Filling& filling, double time) {
  const double phase = 2 * std::numbers::pi * filling.breathing_rate * time;
  return curve(filling.points, time) + filling.breathing_amplitude * std::sin(phase);
}

double TargetVolume::follow(double time, double h) {
  const double change = filling_.max_rate * h;
  ratio_ = std::clamp(told_ ? *told_ : asked(filling_, time), ratio_ - change, ratio_ + change);
  return ratio_;
}

}  // namespace palpate::deformation
