// Rotations as vectors: direction = axis, length = angle [rad]. Exponential and logarithm of SO(3).
#pragma once

#include "modules/core/types.h"

namespace palpate {

/// Unit quaternion of the rotation by |v| about v; any finite v.
Quat rotation_from_vector(const Vec3& v);

/// Shortest rotation vector of unit quaternion `q`, length ≤ π. q and −q give the same, except at
/// exactly half a turn, where the axis' sign is arbitrary.
Vec3 vector_from_rotation(const Quat& q);

/// The shortest rotation that turns direction `a` into direction `b`; any lengths but zero.
Quat rotation_between(const Vec3& a, const Vec3& b);

}  // namespace palpate
