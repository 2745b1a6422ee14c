#include "modules/core/rotation_vector.h"

#include <cmath>

namespace palpate {
namespace {

// Below this angle sin(a/2)/a = 1/2 − a²/48 is exact to double precision (a⁴/3840 < 1e-19) [rad].
constexpr double kSmallAngle = 1e-4;

}  // namespace

Quat rotation_from_vector(const Vec3& v) {
  const double angle = v.norm();
  const double factor =
      angle < kSmallAngle ? 0.5 - angle * angle / 48 : std::sin(0.5 * angle) / angle;
  Quat q;
  q.w() = std::cos(0.5 * angle);
  q.vec() = factor * v;
  return q;
}

Vec3 vector_from_rotation(const Quat& q) {
  const double sign = q.w() < 0 ? -1 : 1;
  const double sine = q.vec().norm();
  const double cosine = sign * q.w();
  if (sine < 0.5 * kSmallAngle) return (sign * 2 / cosine) * (1 - sine * sine / 3) * q.vec();
  return (sign * 2 * std::atan2(sine, cosine) / sine) * q.vec();
}

Quat rotation_between(const Vec3& a, const Vec3& b) { return Quat::FromTwoVectors(a, b); }

}  // namespace palpate
