// Checks and clamps every stage of the haptic chain shares. Safe for any input: NaN, infinite,
// denormal or near the largest double.
#pragma once

#include "modules/core/types.h"

namespace palpate {

/// `v` if no longer than `limit` ≥ 0, else shortened to `limit` (within rounding), same direction.
/// @pre v is finite
Vec3 clamp_length(const Vec3& v, double limit);

/// True if `v` is longer than `limit` ≥ 0; never overflows. @pre v is finite
bool is_longer_than(const Vec3& v, double limit);

}  // namespace palpate
