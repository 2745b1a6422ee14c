#include "deformation/contact/inner_cores.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace palpate::deformation {
namespace {

using geometry::RoundedSegment;

/// From a sharp place to the core [m]: much more than contacts are off by.
constexpr double kInset = 1e-3;
/// Of the least extent, at most.
constexpr double kMostOfExtent = 0.1;

std::vector<RoundedSegment> axis_of(const scene::ConeShape& cone) {
  const double inset = std::min(kInset, kMostOfExtent * cone.length);
  const double radius = inset * cone.radius / std::hypot(cone.radius, cone.length);
  return {{{0, 0, inset}, {0, 0, cone.length - inset}, radius}};
}

std::vector<RoundedSegment> lines_of(const scene::BoxShape& box) {
  const double inset = std::min(kInset, kMostOfExtent * box.size.minCoeff());
  const Vec3 half = box.size / 2 - Vec3::Constant(inset);
  std::vector<RoundedSegment> lines;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int s : {-1, 0, 1}) {
      for (const int t : {-1, 0, 1}) {
        if (s == 0 && t == 0) continue;
        Vec3 end = half;
        end[(axis + 1) % 3] *= s;
        end[(axis + 2) % 3] *= t;
        Vec3 other = end;
        other[axis] = -end[axis];
        lines.push_back({other, end, inset});
      }
    }
  }
  return lines;
}

struct InnerCores {
  std::vector<RoundedSegment> operator()(const scene::ConeShape& cone) const {
    return axis_of(cone);
  }
  std::vector<RoundedSegment> operator()(const scene::BoxShape& box) const { return lines_of(box); }
  template <class Other>
  std::vector<RoundedSegment> operator()(const Other&) const {
    return {};
  }
};

}  // namespace

std::vector<RoundedSegment> inner_cores(const scene::ProbeShape& shape) {
  return std::visit(InnerCores{}, shape);
}

}  // namespace palpate::deformation
