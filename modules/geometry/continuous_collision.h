// Do two moving features meet within a step? Every corner moves linearly.
//
// Point–triangle: F(t,u,v) = p(t) − [(1−u−v) a(t) + u b(t) + v c(t)], u, v ≥ 0, u + v ≤ 1.
// Edge–edge:      F(t,u,v) = [(1−u) a₀(t) + u a₁(t)] − [(1−v) b₀(t) + v b₁(t)].
// They meet iff F has a root in [0,1]³. F is linear in each argument, so over a box its values lie
// in the hull of its eight corner values: if that hull, widened by the rounding error, misses zero,
// the box holds no root and is discarded; else it is halved (inclusion-based root finding: Snyder
// 1992; Wang et al., "A large-scale benchmark and an inclusion-based algorithm for continuous
// collision detection", 2021). So a root is never lost. The hull is taken along the axes and across
// each two of F's slopes. Where a box stays only because of that rounding error, it is looked at
// again in quadruple precision (kMaxQuadTests times at most): features made of the same numbers
// often pass each other by less than a double tells. A near miss closer than kImpactTolerance of
// the coordinates' extent, or one not decided within kMaxImpactBoxes, is reported as a meeting.
#pragma once

#include <array>
#include <optional>

#include "modules/core/types.h"

namespace palpate::geometry {

inline constexpr double kImpactTolerance = 1e-8;
inline constexpr int kMaxImpactBoxes = 20'000;
inline constexpr int kMaxQuadTests = 100;

/// A lower bound of the first time of meeting, close to it, and where. Where a near miss, or what
/// was not decided within kMaxImpactBoxes (edges that stay in one plane: 13 of the 319 meetings
/// among the published queries), is reported, they are of the first box that was left, and may be
/// far from where the features are nearest.
struct Impact {
  double time = 0;      ///< fraction of the step, [0, 1]
  double u = 0, v = 0;  ///< parameters of F there
};

/// Corners at one time: point, a, b, c or a₀, a₁, b₀, b₁.
using FourPoints = std::array<Vec3, 4>;

/// @param separation  features that come closer than this along every axis count as meeting; those
///        closer than twice that may [m], ≥ 0
std::optional<Impact> point_triangle_impact(const FourPoints& start, const FourPoints& end,
                                            double separation = 0);
std::optional<Impact> edge_edge_impact(const FourPoints& start, const FourPoints& end,
                                       double separation = 0);

/// How far the second side, the points from `first_count` on, is beyond the first along a direction
/// [m]. Of points that move linearly it is a concave function of time: sides that are apart by it
/// at both ends of a step are apart all the time.
double gap_along(const Vec3& direction, std::size_t first_count, const FourPoints& points);

}  // namespace palpate::geometry
