#include "collision/wanted_triangles.h"

#include <algorithm>

#include "modules/core/tolerances.h"

namespace palpate::collision {
namespace {

constexpr double kAlmost = 1e-12;         // [m], and relative
constexpr double kAlmostInFloats = 1e-6;  // relative

bool is_bounded(const Bounds& box) { return (box.upper - box.lower).maxCoeff() < 2 * kWorldReach; }

Bounds point(const Vec3& x) { return {x, x}; }

double farthest(const Bounds& box) {
  return box.lower.cwiseAbs().cwiseMax(box.upper.cwiseAbs()).norm();
}

/// Rounded outwards.
void put(const Bounds& box, Four& lower, Four& upper) {
  geometry::BlockBox in_floats;
  in_floats.add(box.lower);
  in_floats.add(box.upper);
  std::copy_n(in_floats.lower.data(), 3, lower.data());
  std::copy_n(in_floats.upper.data(), 3, upper.data());
}

}  // namespace

WantedTriangles::WantedTriangles(const RelativeMotion& motion, const Bounds& core,
                                 double beside_chord)
    : core_P_(core), bounded_(is_bounded(core)), reach_(beside_chord + motion.chord_error()) {
  reach_squared_ = reach_ * reach_;
  const double sure = std::max(0.0, reach_ * (1 - kAlmost) - kAlmost);
  sure_squared_ = sure * sure;
  if (!bounded_) return;
  core_W_ = motion.swept(core);
  in_floats_ = core.lower == core.upper && motion.is_translation();
  const Bounds at_start = in_floats_ ? point(motion.to_world_at_start(core.lower)) : core_W_;
  const Bounds at_end = in_floats_ ? point(motion.to_world_at_end(core.lower)) : core_W_;
  const double rounding =
      in_floats_ ? kAlmostInFloats * (farthest(at_start) + farthest(at_end)) : 0;
  const double above = (reach_ + rounding) * (1 + kAlmostInFloats);
  above_reach_squared_ = static_cast<float>(above * above);
  put(at_start, lower_start_, upper_start_);
  put(at_end, lower_end_, upper_end_);
  Bounds wide = core_W_;
  wide.inflate(in_floats_ ? 2 * above : reach_ * (1 + kAlmost) + kAlmost);
  wide_.add(wide.lower);
  wide_.add(wide.upper);
}

bool WantedTriangles::is_told(const OrganStep& step, const geometry::Triangle& nodes) const {
  const auto of = [&](int k) {
    return apart(step.start_positions()[nodes[k]], step.organ.positions()[nodes[k]]);
  };
  return may_be(of(0), of(1), of(2));
}

bool WantedTriangles::is(const OrganStep& step, const geometry::Triangle& nodes,
                         const std::array<const SweptNode*, 3>& swept) const {
  if (swept[0]->is_sure || swept[1]->is_sure || swept[2]->is_sure) return true;
  Bounds box_P, box_W;
  for (int k = 0; k < 3; ++k) {
    box_P.add(swept[k]->start);
    box_P.add(swept[k]->end);
    box_W.add(step.start_positions()[nodes[k]]);
    box_W.add(step.organ.positions()[nodes[k]]);
  }
  return core_P_.squared_distance(box_P) <= reach_squared_ &&
         (!bounded_ || core_W_.squared_distance(box_W) <= reach_squared_);
}

}  // namespace palpate::collision
