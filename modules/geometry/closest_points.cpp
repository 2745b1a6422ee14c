#include "modules/geometry/closest_points.h"

#include <algorithm>
#include <cmath>

namespace palpate::geometry {
namespace {

constexpr double kFlatArea = 1e-12;

PointOnTriangle on_edge(const TriangleCorners& triangle, int from, int to, double fraction) {
  PointOnTriangle result;
  result.weights[from] = 1 - fraction;
  result.weights[to] = fraction;
  result.point = triangle[from] + fraction * (triangle[to] - triangle[from]);
  return result;
}

PointOnTriangle at_corner(const TriangleCorners& triangle, int corner) {
  return {triangle[corner], Vec3::Unit(corner)};
}

/// Fraction of a–b closest to p.
double closest_fraction(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double length_squared = ab.squaredNorm();
  return length_squared > 0 ? std::clamp(ab.dot(p - a) / length_squared, 0.0, 1.0) : 0;
}

}  // namespace

PointOnTriangle closest_on_triangle(const Vec3& p, const TriangleCorners& triangle) {
  const auto& [a, b, c] = triangle;
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return at_corner(triangle, 0);
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return at_corner(triangle, 1);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return on_edge(triangle, 0, 1, d1 / (d1 - d3));
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return at_corner(triangle, 2);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return on_edge(triangle, 0, 2, d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    return on_edge(triangle, 1, 2, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
  }
  const double sum = va + vb + vc;
  PointOnTriangle result;
  result.weights = {va / sum, vb / sum, vc / sum};
  result.point = result.weights[0] * a + result.weights[1] * b + result.weights[2] * c;
  return result;
}

SegmentPair closest_of_segments(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  const Vec3 d = a1 - a0, e = b1 - b0, r = a0 - b0;
  const double dd = d.squaredNorm(), ee = e.squaredNorm(), de = d.dot(e);
  const double dr = d.dot(r), er = e.dot(r);
  SegmentPair pair;
  if (dd > 0) {
    const double determinant = dd * ee - de * de;
    // Nearly parallel: any s will do, the steps below make the pair closest for it.
    if (determinant > 1e-14 * dd * ee)
      pair.s = std::clamp((de * er - dr * ee) / determinant, 0.0, 1.0);
    pair.t = ee > 0 ? (de * pair.s + er) / ee : 0;
    pair.t = std::clamp(pair.t, 0.0, 1.0);
    pair.s = closest_fraction(b0 + pair.t * e, a0, a1);
    pair.t = closest_fraction(a0 + pair.s * d, b0, b1);
  } else {
    pair.t = closest_fraction(a0, b0, b1);
  }
  pair.on_first = a0 + pair.s * d;
  pair.on_second = b0 + pair.t * e;
  return pair;
}

SegmentAndTriangle closest_of_segment_and_triangle(const Vec3& a, const Vec3& b,
                                                   const TriangleCorners& triangle) {
  SegmentAndTriangle best;
  best.distance = -1;
  const auto consider = [&](const Vec3& on_segment, const PointOnTriangle& on_triangle) {
    const double distance = (on_segment - on_triangle.point).norm();
    if (best.distance < 0 || distance < best.distance) best = {on_segment, on_triangle, distance};
  };
  consider(a, closest_on_triangle(a, triangle));
  consider(b, closest_on_triangle(b, triangle));
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const SegmentPair pair = closest_of_segments(a, b, triangle[k], triangle[next]);
    consider(pair.on_first, on_edge(triangle, k, next, pair.t));
  }
  // Through the inside: the point where the plane is met is its own closest point.
  const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  const double height_a = normal.dot(a - triangle[0]), height_b = normal.dot(b - triangle[0]);
  if ((height_a > 0) != (height_b > 0)) {
    const Vec3 met = a + height_a / (height_a - height_b) * (b - a);
    const PointOnTriangle closest = closest_on_triangle(met, triangle);
    if ((closest.weights.array() > 0).all()) best = {closest.point, closest, 0};
  }
  return best;
}

Vec3 unit_normal(const TriangleCorners& triangle) {
  const Vec3 ab = triangle[1] - triangle[0], ac = triangle[2] - triangle[0];
  const Vec3 normal = ab.cross(ac);
  const double longest =
      std::max({ab.squaredNorm(), ac.squaredNorm(), (triangle[2] - triangle[1]).squaredNorm()});
  const double norm = normal.norm();
  if (!(norm > 2 * kFlatArea * longest) || !std::isfinite(norm)) return Vec3::Zero();
  return normal / norm;
}

}  // namespace palpate::geometry
