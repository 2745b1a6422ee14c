// An organ seen from a probe's frame P over one step: there the probe rests and every node moves,
// to first order linearly, from its old place relative to the old pose to its new one.
#pragma once

#include <cstdint>
#include <vector>

#include "collision/contact_finder.h"
#include "collision/organ_surface.h"

namespace palpate::collision {

class RelativeMotion {
 public:
  /// @param reach  largest distance of the probe's surface from its origin [m]
  /// @param round  the shape looks the same whatever its rotation, which is then held at the end's
  RelativeMotion(const ProbeMotion& motion, double reach, bool round);

  Vec3 start(const Vec3& p_W) const { return to_start_ * (p_W - position_start_); }
  Vec3 end(const Vec3& p_W) const { return to_end_ * (p_W - position_end_); }
  Vec3 to_world_at_start(const Vec3& p_P) const {
    return position_start_ + to_start_.transpose() * p_P;
  }
  Vec3 to_world_at_end(const Vec3& p_P) const { return position_end_ + to_end_.transpose() * p_P; }
  Vec3 direction_at_start(const Vec3& v_W) const { return to_start_ * v_W; }
  Vec3 direction_at_end(const Vec3& v_W) const { return to_end_ * v_W; }

  /// P does not turn.
  bool is_translation() const { return to_start_ == to_end_; }
  /// Way of the probe's origin [m].
  double travel() const { return (position_end_ - position_start_).norm(); }
  /// Bound of how far a node near the probe strays from its chord because P rotates [m]: for a
  /// turn by θ over a way Δ at distance ρ, |x″| ≤ θ²ρ + 2θΔ, and a chord's height is |x″|/8.
  double chord_error() const { return chord_error_; }
  /// World bounds of a probe-fixed box over the step.
  Bounds swept(const Bounds& box_P) const;
  /// Bounds in P, over the step, of a box that rests in the world.
  Bounds seen(const Bounds& box_W) const;

 private:
  Mat3 to_start_, to_end_;  ///< R_PW
  Vec3 position_start_, position_end_;
  double chord_error_ = 0;
};

/// One triangle over the step, in P.
struct SweptTriangle {
  std::uint32_t index = 0;
  geometry::Triangle nodes{};
  geometry::TriangleCorners start, end;
  Vec3 normal_end = Vec3::Zero();  ///< unit, outward
  double travel = 0;               ///< largest way of a corner, rounded up [m]

  geometry::TriangleCorners at(double t) const;
  Bounds bounds() const;
  /// @param squared  of a corner [m²]. @returns its root, rounded up
  static double travel_of(double squared);
  /// Fills in the rest once start and end are there.
  /// @param travel_squared  the largest of a corner [m²]. @returns false for a degenerate triangle
  bool complete(std::uint32_t triangle, const geometry::Triangle& corners, double travel_squared);
};

/// What the searches of one probe on one organ share.
struct OrganStep {
  std::uint32_t organ_index = 0;
  const OrganSurface& organ;
  const RelativeMotion& motion;
  std::uint64_t start_version = 0;  ///< see OrganSurface::positions_at(): where it was at the start
  double margin = 0;                ///< [m]
  /// A wall crossed in this step is believed to be crossed down to this depth, for as long as the
  /// probe stays behind it: the probe's extent and all the way made in this step [m].
  double depth_limit = 0;

  /// @returns false for a degenerate triangle
  bool sweep(std::uint32_t triangle, SweptTriangle& result) const;
  const NodeArray& start_positions() const { return organ.positions_at(start_version); }  ///< in W
  Vec3 node_start(std::uint32_t node) const { return motion.start(start_positions()[node]); }
  Vec3 node_end(std::uint32_t node) const { return motion.end(organ.positions()[node]); }
  /// Sum of the area vectors of the triangles around a node or an edge, in P [m²].
  Vec3 node_normal_end(std::uint32_t node) const;
  Vec3 edge_normal_start(std::uint32_t edge) const;
  Vec3 edge_normal_end(std::uint32_t edge) const;
};

}  // namespace palpate::collision
