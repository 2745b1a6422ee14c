// Checks and clamps every stage of the haptic chain shares. Safe for any input: NaN, infinite,
// denormal or near the largest double.
#pragma once

#include <optional>

#include "modules/core/types.h"

namespace palpate::haptics {

/// Poses further than this from the world's origin are not believed [m].
inline constexpr double kWorldReach = 1000;

/// `v` if no longer than `limit` ≥ 0, else shortened to `limit` (within rounding), same direction.
/// @pre v is finite
Vec3 clamp_length(const Vec3& v, double limit);

/// True if `v` is longer than `limit` ≥ 0; never overflows. @pre v is finite
bool is_longer_than(const Vec3& v, double limit);

/// The pose with its quaternion normalised. Nothing if a number is not finite, the position is
/// beyond kWorldReach, or the quaternion's length is outside [1e-3 … 1e3] (not a rotation).
std::optional<Pose> usable_pose(const Pose& pose);

}  // namespace palpate::haptics
