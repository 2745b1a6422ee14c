// Which triangles, over a step, come near a core: asked of blocks first, then of nodes, then of
// each triangle.
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
    Bounds both;
    both.add(start);
    both.add(end);
    if (bounded_) return core_W_.squared_distance(both) <= reach_squared_;
    Bounds in_P = motion.seen(both);
    in_P.inflate(kDirectionless);  // turning it rounds
    return core_P_.squared_distance(in_P) <= reach_squared_;
  }

  using Row = Eigen::Map<const Four>;  ///< of nodes: floats in a row
  Apart apart(const Vec3& start, const Vec3& end) const {
    geometry::BlockBox box;
    box.add(start);
    box.add(end);
    const auto& [x, y, z] = box.upper;
    return {lower_W_ - Four(x, y, z, 0), Row(box.lower.data()) - upper_W_};
  }
  Apart apart(const Row& start, const Row& end) const {
    return {lower_W_ - start.max(end), start.min(end) - upper_W_};
  }
  /// Holds of every triangle that is wanted, and of few others: in floats, in a few instructions.
  bool may_be(const Apart& x, const Apart& y, const Apart& z) const {
    const Four below = x.below.min(y.below).min(z.below);
    const Four above = x.above.min(y.above).min(z.above);
    return !bounded_ || below.max(above).max(0).square().sum() <= above_reach_squared_;
  }
  /// A node that is so near at the step's end makes its triangles wanted.
  bool is_sure(const Vec3& end) const {
    return core_P_.squared_distance(Bounds{end, end}) <= sure_squared_;
  }
  /// A triangle; judged by its way through the world, too, as its block was.
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
  bool bounded_ = true;
  double reach_ = 0;          ///< [m]
  double reach_squared_ = 0;  ///< [m²]
  double sure_squared_ = 0;   ///< [m²]
  geometry::BlockBox wide_;   ///< core_W_ and the reach
  // core_W_ and, along no axis, anything; a little more than the reach: for apart().
  Four lower_W_ = Four::Constant(-kFar), upper_W_ = Four::Constant(kFar);
  float above_reach_squared_ = 0;
};

}  // namespace palpate::collision
