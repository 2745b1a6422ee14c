// What counts as a unit vector, a direction, a pose: one tolerance per quantity, for messages,
// files and physics alike.
#pragma once

#include <cmath>

#include "modules/core/types.h"

namespace palpate {

/// Allowed deviation of the length of a direction or quaternion, and of a sum of weights, from 1,
/// and of a weight below 0. Some ten roundings of float32 (6e-8): generous to senders that
/// normalise in single precision.
inline constexpr double kUnitTolerance = 1e-6;
/// The same for a quaternion in a text, written with three digits. Its reader normalises it.
inline constexpr double kWrittenUnitTolerance = 1e-3;
/// Two points closer than this have no direction from one to the other [m]: of coordinates up to
/// 1 m, known to 1e-16 m, it would be known to less than 1e-7.
inline constexpr double kDirectionless = 1e-9;
/// Positions further than this from W's origin are not believed [m].
inline constexpr double kWorldReach = 1000;

/// Faster than any hand or surgical tool [m/s]: a probe that seems to move faster has jumped.
inline constexpr double kMaxProbeSpeed = 3.0;

inline bool is_unit(const Vec3& v) { return std::abs(v.norm() - 1) <= kUnitTolerance; }
inline bool is_unit(const Quat& q) { return std::abs(q.norm() - 1) <= kUnitTolerance; }

/// Finite, within kWorldReach, with a rotation.
inline bool is_believable(const Pose& pose) {
  return pose.position.allFinite() && pose.position.stableNorm() <= kWorldReach &&
         is_unit(pose.rotation);
}

}  // namespace palpate
