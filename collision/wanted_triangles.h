// Which triangles, over a step, come near a core: asked of blocks first, then of nodes, then of
// each triangle. Near a point that does not turn, what is asked of all three is the box of their
// way as seen from it, in floats: rounding keeps their order, so that no block is told to be
// further than what it holds.
#pragma once

#include <array>
#include <limits>

#include "collision/node_grid.h"
#include "modules/core/tolerances.h"

namespace palpate::collision {

/// A node over the step, in P.
struct SweptNode {
  Vec3 start, end;
  double travel_squared = 0;
  std::uint32_t index = 0;  ///< of the organ
  bool is_sure = false;     ///< its triangles are wanted
};

/// How far the core is below and above a node's way, along each axis; above 0 where they do not
/// overlap [m].
struct Apart {
  Four below, above;
};

class WantedTriangles {
 public:
  /// @param core          in P; may be without end
  /// @param beside_chord  how near, but for the chord's error [m]
  WantedTriangles(const RelativeMotion& motion, const Bounds& core, double beside_chord);

  double reach() const { return reach_; }  ///< [m]
  double reach_squared() const { return reach_squared_; }

  /// @param start, end  boxes of a block. @returns false only if it holds no wanted triangle
  bool may_be_in(const RelativeMotion& motion, const geometry::BlockBox& start,
                 const geometry::BlockBox& end) const {
    if (bounded_ && !overlaps(start, end)) return false;
    if (in_floats_) {
      const Apart block = apart(start, end);
      return may_be(block, block, block);
    }
    Bounds both;
    both.add(start);
    both.add(end);
    if (bounded_) return core_W_.squared_distance(both) <= reach_squared_;
    Bounds in_P = motion.seen(both);
    in_P.inflate(kDirectionless);  // turning it rounds
    return core_P_.squared_distance(in_P) <= reach_squared_;
  }

  using Row = Eigen::Map<const Four>;  ///< of nodes: floats in a row
  Apart apart(const geometry::BlockBox& start, const geometry::BlockBox& end) const {
    const auto upper = [](const geometry::BlockBox& box) {
      const auto& [x, y, z] = box.upper;
      return Four(x, y, z, 0);
    };
    return {(lower_start_ - upper(start)).min(lower_end_ - upper(end)),
            (Row(start.lower.data()) - upper_start_).min(Row(end.lower.data()) - upper_end_)};
  }
  Apart apart(const Row& start, const Row& end) const {
    return {(lower_start_ - start).min(lower_end_ - end),
            (start - upper_start_).min(end - upper_end_)};
  }
  Apart apart(const Vec3& start, const Vec3& end) const {
    geometry::BlockBox at_start, at_end;
    at_start.add(start);
    at_end.add(end);
    return apart(at_start, at_end);
  }
  /// True of every triangle that is wanted, and of few others; of no others if told_by_floats().
  bool may_be(const Apart& x, const Apart& y, const Apart& z) const {
    const Four below = x.below.min(y.below).min(z.below);
    const Four above = x.above.min(y.above).min(z.above);
    return !bounded_ || below.max(above).max(0).square().sum() <= above_reach_squared_;
  }
  bool told_by_floats() const { return in_floats_; }
  /// A triangle, if told_by_floats().
  bool is_told(const OrganStep& step, const geometry::Triangle& nodes) const;
  /// A node that is so near at the step's end makes its triangles wanted.
  bool is_sure(const Vec3& end) const {
    return core_P_.squared_distance(Bounds{end, end}) <= sure_squared_;
  }
  /// A triangle, if not told_by_floats(); judged by its way through the world, too, as its block
  /// was.
  bool is(const OrganStep& step, const geometry::Triangle& nodes,
          const std::array<const SweptNode*, 3>& swept) const;

 private:
  /// Most blocks are far away: this costs a few instructions each.
  bool overlaps(const geometry::BlockBox& start, const geometry::BlockBox& end) const {
    const Four lower = Row(start.lower.data()).min(Row(end.lower.data()));
    const Four upper = Row(start.lower.data() + 2).max(Row(end.lower.data() + 2));
    const Four lowest(wide_.upper[0], wide_.upper[1], wide_.upper[2], kFar);
    const Four highest(-kFar, wide_.lower[0], wide_.lower[1], wide_.lower[2]);
    return (lower <= lowest).all() && (upper >= highest).all();
  }

  static constexpr float kFar = std::numeric_limits<float>::infinity();
  Bounds core_P_, core_W_;  ///< over the step
  bool bounded_ = true, in_floats_ = false;
  double reach_ = 0;          ///< [m]
  double reach_squared_ = 0;  ///< [m²]
  double sure_squared_ = 0;   ///< [m²]
  geometry::BlockBox wide_;   ///< core_W_ and the reach
  // For apart(): the core at the step's start and end, or for both all of its way; along no axis,
  // anything. And a little more than the reach.
  Four lower_start_ = Four::Constant(-kFar), upper_start_ = Four::Constant(kFar);
  Four lower_end_ = lower_start_, upper_end_ = upper_start_;
  float above_reach_squared_ = 0;
};

}  // namespace palpate::collision
