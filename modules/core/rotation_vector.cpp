#include "modules/core/rotation_vector.h"

#include <cmath>

namespace palpate {
namespace {

// Below this angle sin(a/2)/a = 1/2 − a²/48 is exact to double precision (a⁴/3840 < 1e-19) [rad].
constexpr double kSmallAngle = 1e-4;

// Nearer to opposite than this [rad] rounding turns a × b by more (ε over it) than b is off −a, and
// any axis across a will do.
constexpr double kOpposite = 1.5e-8;

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

// Turning by α about the axis n: cos(α/2) = |a + b|/2, sin(α/2) n = a × b / |a + b|, of unit a and
// b.
Quat rotation_between(const Vec3& a, const Vec3& b) {
  const Vec3 from = a.normalized(), to = b.normalized(), normal = from.cross(to);
  Quat q;
  if (from.dot(to) < 0 && normal.norm() < kOpposite) {
    q.w() = 0;
    q.vec() = from.unitOrthogonal();
    return q;
  }
  const double sum = (from + to).norm();
  q.w() = sum / 2;
  q.vec() = normal / sum;
  return q.normalized();
}

}  // namespace palpate
