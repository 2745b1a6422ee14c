#include "collision/node_grid.h"

#include <algorithm>

namespace palpate::collision {

CoreAtEnd::CoreAtEnd(const RelativeMotion& motion, const Core& core, double reach)
    : is_point_(core.is_point()) {
  const Vec3 a = motion.to_world_at_end(core.a);
  const Vec3 to_b = motion.to_world_at_end(core.b) - a;
  a_.head<3>() = a.cast<float>();
  along_.head<3>() = to_b.cast<float>();
  if (!is_point_) per_length_.head<3>() = (to_b / to_b.squaredNorm()).cast<float>();
  hull_.add(a);
  hull_.add(a + to_b);
  constexpr double kRoundingOfFloats = 1e-6;
  rounding_ = kRoundingOfFloats * (a.norm() + (to_b.cwiseAbs() + Vec3::Constant(2 * reach)).norm());
}

void NodeGrid::begin(const Vec3& lower, const Vec3& size) {
  lower_.head<3>() = lower.cast<float>();
  per_size_.head<3>() = (cells_ / size.array()).cast<float>();
  std::ranges::fill(places_, Place{});
}

bool NodeGrid::would_take(const geometry::BlockBox& box, float squared) const {
  const Eigen::Array4i first = cell_of({box.lower[0], box.lower[1], box.lower[2], 0});
  const Eigen::Array4i last = cell_of({box.upper[0], box.upper[1], box.upper[2], 0});
  for (Eigen::Array4i at = first; at[0] <= last[0]; ++at[0]) {
    for (at[1] = first[1]; at[1] <= last[1]; ++at[1]) {
      for (at[2] = first[2]; at[2] <= last[2]; ++at[2]) {
        if (squared <= places_[place_of(at)].squared) return true;
      }
    }
  }
  return false;
}

}  // namespace palpate::collision
