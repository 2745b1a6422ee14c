#include "collision/wanted_triangles.h"

#include <algorithm>

#include "modules/core/tolerances.h"

namespace palpate::collision {
namespace {

constexpr double kAlmost = 1e-12;         // [m], and relative
constexpr double kAlmostInFloats = 1e-6;  // relative

bool is_bounded(const Bounds& box) { return (box.upper - box.lower).maxCoeff() < 2 * kWorldReach; }

}  // namespace

WantedTriangles::WantedTriangles(const RelativeMotion& motion, const Bounds& core,
                                 double beside_chord)
    : core_P_(core), bounded_(is_bounded(core)), reach_(beside_chord + motion.chord_error()) {
  reach_squared_ = reach_ * reach_;
  const double sure = std::max(0.0, reach_ * (1 - kAlmost) - kAlmost);
  sure_squared_ = sure * sure;
  if (!bounded_) return;
  core_W_ = motion.swept(core);
  Bounds wide = core_W_;
  wide.inflate(reach_ * (1 + kAlmost) + kAlmost);
  wide_.add(wide.lower);
  wide_.add(wide.upper);
  geometry::BlockBox in_floats;
  in_floats.add(core_W_.lower);
  in_floats.add(core_W_.upper);
  std::copy_n(in_floats.lower.data(), 3, lower_W_.data());
  std::copy_n(in_floats.upper.data(), 3, upper_W_.data());
  above_reach_squared_ = static_cast<float>(reach_squared_ * (1 + kAlmostInFloats));
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
